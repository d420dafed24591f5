// The bar in a worker: the first message brings the canvas, each further one the page's look.

import { runBar } from "./runbar.js";

let bar = null;

onmessage = ({ data }) => {
  bar ??= runBar(data.canvas, (news) => postMessage(news));
  if (data.look) bar.fit(data.look);
};
