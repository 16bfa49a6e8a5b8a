#!/bin/sh
# Every relative link in the pages leads somewhere, to a heading that is there where it names one, and so does every path
# in backticks that ends in a file's name.
#   check_links.sh REPOSITORY
set -eu
cd "$1"

missing=0
seen=0
complain() {
  echo "$1: $2 leads nowhere" >&2
  missing=$((missing + 1))
}

# The places that a page's headings make, as GitHub names them.
places() {
  grep -E '^#+ ' "$1" | sed -E 's/^#+ +//' | tr '[:upper:]' '[:lower:]' | sed -E 's/[^a-z0-9 _-]//g; s/ /-/g'
}

for page in README.md docs/*.md protocol/*.md; do
  folder=$(dirname "$page")
  # Links and pictures, without those to other machines and to places on the same page.
  targets=$(grep -oE '\]\([^)#: ]+(#[^)]*)?\)|src="[^":]+"' "$page" |
    sed -E 's/^\]\(//; s/\)$//; s/^src="//; s/"$//; s/#.*//') || true
  for target in $targets; do
    seen=$((seen + 1))
    [ -e "$folder/$target" ] || complain "$page" "the link to $target"
  done
  # Places on this page and on others.
  for link in $(grep -oE '\]\([^): ]*#[^)]*\)' "$page" | sed -E 's/^\]\(//; s/\)$//'); do
    seen=$((seen + 1))
    target=${link%%#*}
    file=${target:+$folder/$target}
    places "${file:-$page}" 2>/dev/null | grep -qxF -- "${link#*#}" || complain "$page" "the link to $link"
  done
  # A path in backticks counts from the top of the repository and has a folder in it.
  paths=$(grep -oE '`[A-Za-z0-9_.-]+(/[A-Za-z0-9_.-]+)*/([A-Za-z0-9_.-]+\.(h|cpp|fbs|md|json|sh|txt|ts|mjs|yaml|lsan|supp))?`' "$page" |
    tr -d '`') || true
  for path in $paths; do
    seen=$((seen + 1))
    [ -e "$path" ] || complain "$page" "the path $path"
  done
done

[ "$seen" -gt 20 ] || { echo "only $seen links and paths were found: this check is broken" >&2; exit 1; }
[ "$missing" -eq 0 ] || exit 1
echo "$seen links and paths lead somewhere"
