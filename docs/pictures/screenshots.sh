#!/bin/sh
# Screenshots of the reports of hertz3d and signorini3d by a real browser: narrow and wide, light and dark, and printed.
#
#   sh docs/pictures/screenshots.sh [FOLDER [OPTIONS OF BOTH PROGRAMS]]
#
# It needs cargo, Chromium and pdftoppm (Debian: apt-get install chromium poppler-utils). FOLDER is results/screenshots if it is left out; it
# must not exist yet. There, NAME/report.html is the report, NAME_WIDTH_COLOURS.png a screenshot, NAME_print-NUMBER.png a printed page.
set -eu
here=$(cd "$(dirname "$0")/../.." && pwd)
folder=${1:-results/screenshots}
[ $# -gt 0 ] && shift
mkdir -p "$(dirname "$folder")"
mkdir "$folder"
folder=$(cd "$folder" && pwd)
for program in chromium pdftoppm; do
    command -v "$program" > /dev/null || { echo "$program is missing: apt-get install chromium poppler-utils" >&2; exit 1; }
done
browser() {
    chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --allow-file-access-from-files --virtual-time-budget=2000 "$@" \
        > "$folder/chromium.log" 2>&1
}
for name in hertz signorini; do
    (cd "$here" && cargo run --release --locked -p problems --bin "${name}3d" -- "$@" --out "$folder/$name" > "$folder/$name.txt")
    for width in 400 1600; do
        # A window is at least 500 pixels wide: the page stands in a frame.
        cat > "$folder/frame.html" <<FRAME
<!DOCTYPE html><style>body { margin: 0 } iframe { border: 0; display: block }</style>
<iframe src="$name/report.html" width="$width" height="${HEIGHT:-9000}"></iframe>
FRAME
        for colours in light:1 dark:0; do
            browser --window-size="$width,${HEIGHT:-9000}" --blink-settings="preferredColorScheme=${colours#*:}" \
                --screenshot="$folder/${name}_${width}_${colours%:*}.png" "file://$folder/frame.html"
        done
    done
    browser --no-pdf-header-footer --print-to-pdf="$folder/${name}_print.pdf" "file://$folder/$name/report.html"
    pdftoppm -r 60 -png "$folder/${name}_print.pdf" "$folder/${name}_print"
done
rm -f "$folder/frame.html" "$folder/chromium.log"
ls -l "$folder"
