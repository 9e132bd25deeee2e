#!/bin/sh
# Bundles viewer.js with the parts of three.js that it uses into viewer.min.js, and writes its hash. It needs Node.js and npm.
set -eu
cd "$(dirname "$0")"
npm ci --no-audit --no-fund
npx esbuild viewer.js --bundle --minify --format=iife --target=es2022 --charset=utf8 --legal-comments=inline --outfile=viewer.min.js
cp node_modules/three/LICENSE THREE-LICENSE
sha256sum viewer.min.js > viewer.min.js.sha256
hash=$(cut -d ' ' -f 1 viewer.min.js.sha256)
sed "s/^    [0-9A-Za-z]*$/    $hash/" README.md > README.new && mv README.new README.md
cat viewer.min.js.sha256
