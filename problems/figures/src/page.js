// The title of what the pointer is on, below its figure.
for (const figure of document.querySelectorAll("figure")) {
  const told = figure.querySelector("output");
  if (told) {
    told.textContent = "Point at a node or a mark for its number and value.";
    const tell = (event) => {
      const title = event.target.querySelector(":scope > title");
      if (title && event.target.tagName !== "svg") told.textContent = title.textContent;
    };
    figure.addEventListener("pointerover", tell);
    figure.addEventListener("pointerdown", tell);
  }
}
