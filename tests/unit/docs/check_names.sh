#!/bin/sh
# Every row of the table in docs/paper-to-code.md names files that exist and names that stand in their
# code, and every equation, algorithm and section of the paper has a row.
#   check_names.sh REPOSITORY
set -eu
cd "$1"
page=docs/paper-to-code.md

# The last cell of each row, one word in backticks a line: a path, then names in that file.
words=$(sed -nE 's/^\|.*\|([^|]*)\|$/\1/p' "$page" | grep -oE '`[^`]+`' | tr -d '`')
missing=0
seen=0
file=
for word in $words; do
  case $word in
    */*)
      file=$word
      if [ ! -f "$file" ]; then
        echo "$page: there is no file $file" >&2
        missing=$((missing + 1))
      fi
      ;;
    *)
      seen=$((seen + 1))
      # In a comment it would be no more than a promise.
      if ! sed 's,//.*,,' "$file" 2>/dev/null | grep -wF -- "$word" >/dev/null; then
        echo "$page: $word does not stand in $file" >&2
        missing=$((missing + 1))
      fi
      ;;
  esac
done

for part in "Equation (1)" "Equation (2)" "Equation (3)" "Equation (4)" \
  "Algorithm 1" "Algorithm 2" "Algorithm 3" "Algorithm 4" "Algorithm 5" "Algorithm 6" \
  "Section 3.1" "Section 3.2" "Section 3.3" "Section 3.4" "Section 3.5" "Section 3.6" \
  "Section 4.1" "Section 4.2" "Section 5"; do
  if ! grep -qF "| $part |" "$page"; then
    echo "$page: $part has no row" >&2
    missing=$((missing + 1))
  fi
done

[ "$seen" -gt 40 ] || { echo "only $seen names were found: this check is broken" >&2; exit 1; }
[ "$missing" -eq 0 ] || exit 1
echo "$seen names stand where the page says"
