"use strict";
// Draws every figure when the page opens, a few at a time, so that the words can be read meanwhile; again where the
// window turns narrow or the reader's colours dark; and at paper width, in the colours of paper, to print.
(async () => {
  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  const figures = read("figure-data");
  const { template, dark: darkColours } = read("style");
  for (const { layout, narrow } of Object.values(figures)) for (const one of [layout, narrow]) if (one) one.template = template;
  const places = [...document.querySelectorAll("div.plot")];
  const narrow = matchMedia("(max-width: 640px)");
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const PAPER_WIDTH = 328, PAPER_WIDE = 686; // px, a column and the whole text of an A4 page
  const SHRINK = 0.6, PAPER_HEIGHT = 0.95;
  const SIZES = new Set(["size", "height", "l", "r", "t", "b", "standoff", "thickness"]);
  const config = (key) => ({
    responsive: true,
    displaylogo: false,
    modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"],
    toImageButtonOptions: { format: "svg", filename: key },
  });
  const inDark = (key, value) => {
    if (typeof value !== "string" || value[0] !== "#") return value;
    const found = darkColours[value.slice(0, 7)];
    return found ? found + value.slice(7) : value;
  };
  const shown = (place) => {
    const { data, layout, narrow: stacked } = figures[place.dataset.figure];
    const drawing = { data, layout: narrow.matches && stacked ? stacked : layout };
    return JSON.parse(JSON.stringify(drawing), dark.matches ? inDark : undefined);
  };
  const draw = (place) => {
    const { data, layout } = shown(place);
    place.style.minHeight = `${layout.height}px`;
    return Plotly.react(place, data, layout, config(place.dataset.figure));
  };
  const drawAll = async () => {
    for (const place of places) {
      await draw(place);
      await new Promise((next) => setTimeout(next));
    }
    document.documentElement.dataset.drawn = places.length;
  };
  const shrunk = (drawing) => JSON.parse(JSON.stringify(drawing), (key, value) =>
    (typeof value === "number" && SIZES.has(key) ? value * SHRINK : value));
  const forPaper = (place) => {
    const { data, layout } = shrunk(figures[place.dataset.figure]);
    layout.width = place.closest("figure").classList.contains("wide") ? PAPER_WIDE : PAPER_WIDTH;
    layout.height *= PAPER_HEIGHT;
    place.style.minHeight = 0;
    Plotly.react(place, data, layout, { staticPlot: true });
  };
  const unpacked = async (id) => {
    const packed = Uint8Array.from(atob(document.getElementById(id).textContent), (letter) => letter.charCodeAt(0));
    return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  };
  for (const place of places) place.style.minHeight = `${figures[place.dataset.figure].layout.height}px`;
  document.head.append(Object.assign(document.createElement("script"), { text: await unpacked("plotly") }));
  addEventListener("beforeprint", () => places.forEach(forPaper));
  addEventListener("afterprint", () => places.forEach(draw));
  for (const query of [narrow, dark]) query.addEventListener("change", drawAll);
  drawAll();
})().catch((problem) => {
  document.querySelectorAll("div.plot").forEach((place) => { place.textContent = `This browser cannot draw the plots: ${problem}`; });
});
