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
