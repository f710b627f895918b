// What `.ci/page` runs in each page, after the script of the page: the pixels show what the recording holds.
"use strict";
const is = {
  blue: (r, g, b) => b > r + 50 && b > g + 20,
  orange: (r, g, b) => r > g + 30 && g > b + 35,
  gap: (r, g, b) => r > 220 && g < 120 && b > 140,
  lit: (r, g, b) => g > r + 50 && g > b + 50,
  yellow: (r, g, b) => r > 200 && g > 170 && b < 110,
  drawn: (r, g, b) => Math.abs(r - 237) > 2 || Math.abs(g - 240) > 2 || Math.abs(b - 245) > 2,
};
const failures = [];
const check = (truth, ...words) => truth || failures.push(words.join(" "));

function size(width, height) {
  Object.assign(canvas.style, { width: `${width}px`, height: `${height}px` });
  draw();
}
function pixels() {
  draw();
  const all = new Uint8Array(4 * canvas.width * canvas.height);
  gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, all);
  return all;
}
function count(all, of) {
  let n = 0;
  for (let i = 0; i < all.length; i += 4) n += is[of](all[i], all[i + 1], all[i + 2]) ? 1 : 0;
  return n;
}
const differ = (p, q) => p.reduce((n, x, i) => n + (x === q[i] ? 0 : 1), 0);
function slide(frame) {
  at("frame").value = frame;
  at("frame").dispatchEvent(new Event("input"));
  check(state.frame === frame, "the slider shows frame", state.frame, "not", frame);
}
function flip(key) {
  const box = at("switches").children[Object.keys(show).indexOf(key)].firstChild;
  box.checked = !box.checked;
  box.onchange();
}

const checks = {
  pair() {
    slide(20);
    const first = pixels();
    for (const [of, least] of [["blue", 3000], ["orange", 1500], ["gap", 100]]) check(count(first, of) > least, of, count(first, of));
    // Two vertices, then two edges.
    for (const frame of [10, 30]) { slide(frame); check(count(pixels(), "lit") > 100, "lit at", frame, count(pixels(), "lit")); }
    slide(20);
    check(differ(first, pixels()) === 0, "the same frame gives another picture");
    flip("witnesses");
    const without = pixels();
    check(count(without, "gap") + count(without, "lit") < 20, "closest points that are switched off");
    flip("witnesses");
    flip("regions");
    check(differ(first, pixels()) > 500, "regions");
    flip("regions");
    slide(70);
    check(differ(first, pixels()) > 500, "another frame gives the same picture");
    check(at("told").textContent.startsWith("contact state") && at("count").textContent === "frame 70 of 120", "the panel");
    // A click on the second body chooses it.
    slide(20);
    const all = pixels(), sum = [0, 0, 0];
    for (let i = 0; i < all.length; i += 4) if (is.orange(all[i], all[i + 1], all[i + 2])) {
      sum[0] += (i / 4) % canvas.width;
      sum[1] += Math.floor(i / 4 / canvas.width);
      sum[2] += 1;
    }
    pick({ clientX: sum[0] / sum[2], clientY: canvas.height - sum[1] / sum[2] });
    check(state.body === 1, "the click chooses body", state.body);
    const [yaw, before] = [camera.yaw, pixels()];
    canvas.dispatchEvent(new PointerEvent("pointermove", { buttons: 1, movementX: 40, movementY: 10 }));
    check(camera.yaw !== yaw && differ(before, pixels()) > 500, "a drag rotates");
  },
  kinds() {
    flip("witnesses");
    const shown = states[state.frame].poses, poses = [...shown];
    poses.forEach((pose, body) => {
      shown.fill(null);
      shown[body] = pose;
      check(count(pixels(), "drawn") > 400, data.bodies[body].name, count(pixels(), "drawn"));
    });
  },
  pile() {
    slide(30);
    const plain = pixels();
    check(count(plain, "yellow") > 100, "contacts");
    for (const key of ["boxes", "columns", "regions", "contacts"]) {
      flip(key);
      check(differ(plain, pixels()) > 500, key);
      flip(key);
    }
    const written = () => names.getContext("2d").getImageData(0, 0, names.width, names.height).data.some((x) => x > 0);
    check(written(), "names of contacts");
    flip("names");
    check(!written(), "names that are switched off");
  },
  cast() {
    const plain = pixels();
    flip("brackets");
    check(differ(plain, pixels()) > 500, "brackets");
    flip("brackets");
    check(differ(plain, pixels()) === 0, "brackets again");
  },
};

// Compares the page with a picture: other rasterisers move edges by a pixel.
function compare() {
  size(900, 620);
  const image = at("reference"), paper = new OffscreenCanvas(canvas.width, canvas.height), ink = paper.getContext("2d", { willReadFrequently: true });
  check(image.naturalWidth === canvas.width && image.naturalHeight === canvas.height, "the size of the picture");
  ink.drawImage(image, 0, 0);
  const there = ink.getImageData(0, 0, canvas.width, canvas.height).data;
  ink.drawImage(canvas, 0, 0);
  const here = ink.getImageData(0, 0, canvas.width, canvas.height).data;
  let others = 0;
  for (let i = 0; i < here.length; i += 4) others += [0, 1, 2].some((k) => Math.abs(here[i + k] - there[i + k]) > 40) ? 1 : 0;
  check(others < 0.01 * canvas.width * canvas.height, others, "pixels differ from the picture");
}

function run() {
  if (!gl) return "no WebGL 2";
  if (asked.get("check") === "draw") { size(900, 620); return canvas.toDataURL().split(",")[1]; }
  if (asked.get("check") === "picture") compare();
  else {
    size(640, 480);
    checks[location.pathname.split("/").at(-1).replace(".html", "")]();
  }
  return failures.length ? failures.join("; ") : "passed";
}
// After the picture is decoded.
window.addEventListener("load", () => {
  let text;
  try { text = run(); } catch (error) { text = String(error); }
  document.body.append(Object.assign(document.createElement("pre"), { id: "check", textContent: text }));
});
