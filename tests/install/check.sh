#!/usr/bin/env bash
# check.sh BUILD_FOLDER WORK_FOLDER: installs the build under WORK_FOLDER, builds a small project against it with
# find_package(arete), runs it, and looks at the installed command, its manual and its completions.
set -euo pipefail
build=$1 work=$2
here=$(cd "$(dirname "$0")" && pwd)
prefix=$work/prefix
rm -rf "$work"
mkdir -p "$work"

cmake --install "$build" --prefix "$prefix" >"$work/install.log"
sanitize=$(grep '^ARETE_SANITIZE:' "$build/CMakeCache.txt" | cut -d= -f2)
flags=()
[ "$sanitize" = ON ] && flags=("-DCMAKE_CXX_FLAGS=-fsanitize=address,undefined")
cmake -S "$here/consumer" -B "$work/build" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" "${flags[@]}" >"$work/configure.log"
cmake --build "$work/build" >"$work/build.log"

expect() {  # expect WHAT WANTED FOUND
  [ "$2" = "$3" ] || { echo "$1: expected '$2', found '$3'" >&2; exit 1; }
}
# Means of the 2 x 2 blocks of x + 10 y on a 4 x 4 grid: 5.5 in the first corner, 2.5 + 25 in the last.
expect consumer "5.5 27.5, cell 30 x 20" "$("$work/build/consumer")"

version=$("$prefix/bin/arete" --version)
expect version "arete $(sed -n 's/^CMAKE_PROJECT_VERSION:STATIC=//p' "$build/CMakeCache.txt")" "$version"
for page in arete.1 arete-completion.1; do
  [ -s "$prefix/share/man/man1/$page" ] || { echo "$page is not installed" >&2; exit 1; }
done
for script in bash-completion/completions/arete zsh/site-functions/_arete fish/vendor_completions.d/arete.fish; do
  [ -s "$prefix/share/$script" ] || { echo "$script is not installed" >&2; exit 1; }
done
# The completion that is installed offers the verbs.
bash -c '. "$1"; COMP_WORDS=(arete complet); COMP_CWORD=1; _arete; [ "${COMPREPLY[*]}" = completion ]' _ \
  "$prefix/share/bash-completion/completions/arete" || { echo "bash completion does not complete 'arete complet'" >&2; exit 1; }
# The dictionaries that are installed are found by name, and by the digest in a tree.
printf 'ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 100\n1 5 9\n4 2 8\n' >"$work/dem.asc"
"$prefix/bin/arete" compress "$work/dem.asc" "$work/dem.sct" --profile paper --dictionary alps_srtm_30m_x4 --quiet >"$work/compress.log"
"$prefix/bin/arete" info "$work/dem.sct" | grep -qF "$prefix/share/arete/dictionaries/alps_srtm_30m_x4.atoms" ||
  { echo "the installed command does not find its dictionaries" >&2; exit 1; }
