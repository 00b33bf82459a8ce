"use strict";
// Draws every figure when the page opens, a few at a time, so that the words can be read meanwhile; and again at paper width to print.
(async () => {
  const figures = JSON.parse(document.getElementById("figure-data").textContent);
  const places = [...document.querySelectorAll("div.plot")];
  const PAPER_WIDTH = 686; // px, the text of an A4 page
  const SHRINK = 0.76;
  const SIZES = new Set(["size", "height", "l", "r", "t", "b", "standoff"]);
  const config = (key) => ({
    responsive: true,
    displaylogo: false,
    modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"],
    toImageButtonOptions: { format: "svg", filename: key },
  });
  const draw = (place) => {
    const { data, layout } = figures[place.dataset.figure];
    return Plotly.newPlot(place, data, layout, config(place.dataset.figure));
  };
  const drawAll = async () => {
    for (const place of places) {
      await draw(place);
      await new Promise((next) => setTimeout(next));
    }
    document.documentElement.dataset.drawn = places.length;
  };
  for (const place of places) place.style.minHeight = `${figures[place.dataset.figure].layout.height}px`;
  const shrunk = (layout) => JSON.parse(JSON.stringify(layout), (key, value) =>
    (typeof value === "number" && SIZES.has(key) ? value * SHRINK : value));
  const forPaper = (place) => {
    const { data, layout } = figures[place.dataset.figure];
    place.style.minHeight = 0;
    Plotly.react(place, data, { ...shrunk(layout), width: PAPER_WIDTH }, { staticPlot: true });
  };
  const unfold = (open) => document.querySelectorAll("details").forEach((part) => { part.open = open; });
  const unpacked = async (id) => {
    const packed = Uint8Array.from(atob(document.getElementById(id).textContent), (letter) => letter.charCodeAt(0));
    return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  };
  document.head.append(Object.assign(document.createElement("script"), { text: await unpacked("plotly") }));
  addEventListener("beforeprint", () => { places.forEach(forPaper); unfold(true); });
  addEventListener("afterprint", () => { places.forEach(draw); unfold(false); });
  drawAll();
})().catch((problem) => {
  document.querySelectorAll("div.plot").forEach((place) => { place.textContent = `This browser cannot draw the plots: ${problem}`; });
});
