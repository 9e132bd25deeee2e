// The title of what the pointer is on, below its figure.
for (const figure of document.querySelectorAll("figure")) {
  const told = figure.querySelector("output");
  if (told) {
    const nodes = figure.querySelector(".nodes");
    told.textContent = nodes ? "Point at a node for its place and value." : "Point at a mark for its evaluation and value.";
    const tell = (event) => {
      const title = event.target.querySelector(":scope > title");
      if (title && event.target.tagName !== "svg") told.textContent = title.textContent;
    };
    figure.addEventListener("pointerover", tell);
    figure.addEventListener("pointerdown", tell);
  }
}

// Views in three dimensions: their script is packed, since it is larger than most pages.
const library = document.getElementById("space-library");
// Browsers that cannot unpack it show the pictures alone.
if (library && "DecompressionStream" in window) {
  const packed = Uint8Array.from(atob(library.textContent), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  new Response(stream).text().then((text) => {
    const script = document.createElement("script");
    script.textContent = text;
    document.body.append(script);
  });
}
