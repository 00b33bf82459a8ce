"use strict";
// Draws every figure when the page opens, a few at a time, so that the words can be read meanwhile; and again at paper width to print.
(() => {
  const figures = JSON.parse(document.getElementById("figures").textContent);
  const places = [...document.querySelectorAll("div.plot")];
  const PAPER_WIDTH = 700;
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
  const fit = (width) => places.forEach((place) => place.data && Plotly.relayout(place, { width, autosize: width === null }));
  const unfold = (open) => document.querySelectorAll("details").forEach((part) => { part.open = open; });
  addEventListener("beforeprint", () => { fit(PAPER_WIDTH); unfold(true); });
  addEventListener("afterprint", () => { fit(null); unfold(false); });
  drawAll();
})();
