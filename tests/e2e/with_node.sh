#!/bin/sh
# Runs node with the given arguments, after making sure that node and the npm packages of the tests are there.
set -eu
web=$(cd "$(dirname "$0")/../../web" && pwd)
if ! command -v node >/dev/null 2>&1; then
  echo "node is missing; install it with: apt-get install nodejs npm" >&2
  exit 1
fi
for package in typescript playwright-core ws; do
  if [ ! -d "$web/node_modules/$package" ]; then
    echo "the npm package $package is missing; install the packages of the tests with: cd $web && npm ci" >&2
    exit 1
  fi
done
exec node "$@"
