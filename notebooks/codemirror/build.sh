#!/bin/sh
# Makes codemirror.js and LICENSES.txt from the versions in package.json, in a folder of its own; needs node and npm.
# Only whoever changes a version or entry.js runs it: the workbench uses the committed codemirror.js.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$here/package.json" "$here/entry.js" "$work"
cd "$work"
npm install --no-package-lock --no-audit --no-fund --loglevel=error
banner="/* CodeMirror 6, bundled by build.sh from the versions in package.json; licences: LICENSES.txt (all MIT). */"
node_modules/.bin/esbuild entry.js --bundle --minify --format=esm --target=es2022 --charset=utf8 \
  --legal-comments=none --banner:js="$banner" --outfile="$here/codemirror.js"
node - "$here/LICENSES.txt" <<'SCRIPT'
const fs = require("fs");
const names = Object.keys(JSON.parse(fs.readFileSync("package.json", "utf8")).dependencies).sort();
const texts = names.map((name) => {
  const folder = `node_modules/${name}`;
  const { version } = JSON.parse(fs.readFileSync(`${folder}/package.json`, "utf8"));
  const licence = fs.readdirSync(folder).find((file) => /^licen[cs]e/i.test(file));
  return `${name} ${version}\n\n${fs.readFileSync(`${folder}/${licence}`, "utf8").trim()}\n`;
});
fs.writeFileSync(process.argv[2], `codemirror.js contains these packages.\n\n${texts.join(`\n${"-".repeat(80)}\n\n`)}`);
SCRIPT
