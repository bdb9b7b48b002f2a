// The page of a study report in headless Chromium: draws, switches, sorts, darkens, fits a phone, prints.
//   node report_browser.mjs MODULES SAMPLE FOLDER    SAMPLE: the program report_sample; pictures go to FOLDER

import assert from "node:assert/strict";
import {execFileSync} from "node:child_process";
import {existsSync, mkdirSync, readFileSync, rmSync} from "node:fs";
import {createRequire} from "node:module";
import {join} from "node:path";
import {pathToFileURL} from "node:url";

const [modules, sample, folder] = process.argv.slice(2);

function findChromium() {
  const names = ["chromium", "chromium-browser", "google-chrome"];
  const places = process.env.PATH.split(":").flatMap((place) => names.map((name) => join(place, name)));
  return [process.env.SWEEPGRID_CHROMIUM, ...places].find((path) => path && existsSync(path));
}
const executablePath = findChromium();
if (!executablePath) {
  console.error("Chromium is not installed (Debian: apt-get install chromium), so the page cannot be tried");
  process.exit(1);
}

rmSync(folder, {recursive: true, force: true});
mkdirSync(folder, {recursive: true});
const [json, html] = execFileSync(sample, [folder], {encoding: "utf8"}).trim().split("\n");
const report = JSON.parse(readFileSync(json, "utf8"));
const all = (kind) => report.sections.flatMap((section) => section[kind]);

const {chromium} = createRequire(join(modules, "package.json"))("playwright-core");
const browser = await chromium.launch({executablePath, args: ["--no-sandbox", "--disable-gpu", "--disable-quic",
  "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"]});

// Opens the page; whatever it complains of, or asks of the network, fails the test.
async function open(width, height, colorScheme = "light") {
  const context = await browser.newContext({viewport: {width, height}, colorScheme, deviceScaleFactor: 1});
  const page = await context.newPage();
  page.complaints = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) page.complaints.push(message.text());
  });
  page.on("pageerror", (error) => page.complaints.push(error.stack));
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) page.complaints.push(`asks for ${request.url()}`);
  });
  await page.goto(pathToFileURL(html).href);
  return page;
}

const marksOf = (page, id) => page.locator(`#${id} .chart svg path, #${id} .chart svg rect`).count();
// Charts are drawn again when the browser next paints.
const painted = (page) => page.evaluate(() =>
  new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done()))));
const picture = (page, name) => page.screenshot({path: join(folder, `${name}.png`), fullPage: true});
const tests = [];
const test = (name, width, run, scheme) => tests.push({name, width, run, scheme});
// Opening a page takes most of the time, so those that only look, or leave all as it was, share one.
const look = (name, run) => tests.push({name, width: 1280, run, shared: true});

look("every chart has marks", async (page) => {
  assert.equal(await page.title(), report.title);
  assert.equal(await page.locator("h1").textContent(), report.title);
  for (const chart of all("charts")) {
    const points = chart.series.flatMap(({points}) => points).filter(({y}) => typeof y === "number").length;
    assert.ok(await marksOf(page, chart.id) >= points / 2, `${chart.id}: ${await marksOf(page, chart.id)} marks`);
  }
  for (const map of all("maps")) assert.ok(await marksOf(page, map.id) >= map.tiles.length, map.id);
  const [small, large] = all("timelines");
  assert.ok(await marksOf(page, small.id) >= small.spans.length, small.id);
  // Too many for elements: the pixels are looked at.
  const colours = await page.locator(`#${large.id} canvas`).evaluate((canvas) => {
    const {data} = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return new Set(new Uint32Array(data.buffer)).size;
  });
  assert.ok(colours > large.groups.length, `${colours} colours`);
  for (const {id, caption} of [...all("charts"), ...all("maps"), ...all("timelines"), ...all("tables")]) {
    assert.equal(await page.locator(`#${id} figcaption`).textContent(), caption.replaceAll("`", ""));
  }
  const labels = await page.locator(".chart").evaluateAll((charts) => charts.map((chart) => chart.ariaLabel));
  assert.ok(labels.length > 0 && labels.every((label) => label?.length > 20));
  await picture(page, "desktop");
});

look("error bars reach from the least to the most", async (page) => {
  const lengths = await page.locator('#speed-up .chart svg path[stroke-width="1.5"]').evaluateAll((paths) =>
    paths.map((path) => path.getBBox()).filter(({width}) => width === 0).map(({height}) => height));
  // Three, of one relative spread: on an axis of logarithms they are equally long.
  assert.equal(lengths.length, 3);
  for (const length of lengths) assert.ok(length > 3 && Math.abs(length - lengths[0]) < 0.1, `lengths ${lengths}`);
});

look("simulated series are dashed and say so", async (page) => {
  const legend = page.locator("#speed-up .legend button");
  assert.deepEqual(await legend.allTextContents(),
    ["uniform 1e6", "work stealing (simulated)", "static ranges (simulated)", "ideal"]);
  assert.ok(await page.locator('#speed-up .chart svg path[stroke-dasharray^="6,4"]').count() >= 2);
});

look("legends switch series off and on, with the keyboard too", async (page) => {
  for (const {id} of [...all("charts").slice(0, 2), all("timelines")[0]]) {
    const before = await marksOf(page, id);
    const button = page.locator(`#${id} .legend button`).nth(1);
    await button.focus();
    await page.keyboard.press("Enter");
    await painted(page);
    assert.equal(await button.getAttribute("aria-pressed"), "false");
    assert.ok(await marksOf(page, id) < before, `${id}: still ${before} marks`);
    await button.click();
    await painted(page);
    assert.equal(await button.getAttribute("aria-pressed"), "true");
    assert.equal(await marksOf(page, id), before);
  }
});

test("a series that is off stays off when colours change", 1280, async (page) => {
  await page.locator("#growth .legend button").first().click();
  await painted(page);
  const before = await marksOf(page, "growth");
  await page.locator("#theme").click();
  await painted(page);
  assert.equal(await marksOf(page, "growth"), before);
});

look("tooltips tell the numbers", async (page) => {
  await page.locator("#growth .chart").scrollIntoViewIfNeeded();
  const box = await page.locator("#growth .chart").boundingBox();
  await page.mouse.move(box.x + box.width * 0.6, box.y + box.height * 0.5);
  const tip = page.locator("#growth .tip");
  await tip.waitFor();
  assert.match(await tip.textContent(), /objects.*classic.*ms.*batch/);
  await page.locator("#kinds .chart").scrollIntoViewIfNeeded();
  const tile = await page.locator("#kinds .chart").boundingBox();
  await page.mouse.move(tile.x + tile.width * 0.5, tile.y + 60);
  await page.locator("#kinds .tip").waitFor();
  assert.match(await page.locator("#kinds .tip").textContent(), /%.*time per step.*ms/);
});

test("tables sort numbers as numbers and texts as texts", 1280, async (page) => {
  const column = (index) => page.locator(`#claims tbody tr td:nth-child(${index + 1})`).evaluateAll((cells) =>
    cells.map((cell) => cell.firstChild?.textContent ?? ""));
  const press = (index) => page.locator("#claims th button").nth(index).click();
  const asWritten = await column(0);
  await press(2);
  assert.deepEqual(await column(2), ["1.76", "9", "30 %", "80", "300"]);
  await press(2);
  assert.deepEqual(await column(2), ["300", "80", "30 %", "9", "1.76"]);
  await press(2);
  assert.deepEqual(await column(0), asWritten);
  await press(3);
  assert.deepEqual(await column(3), ["1.74", "72", "1 041 %", "never", ""]);
  await press(1);
  assert.deepEqual(await column(1), ["2.2", "4.1", "4.2", "4.3", "4.10"]);
  assert.deepEqual(await page.locator("#claims th").evaluateAll((heads) => heads.map((head) => head.ariaSort)),
    [null, "ascending", null, null, null, null]);
});

test("timelines zoom", 1280, async (page) => {
  const chart = page.locator("#step .chart");
  const before = await marksOf(page, "step");
  await chart.scrollIntoViewIfNeeded();
  const box = await chart.boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 3);
  await page.keyboard.down("Control");
  for (let turn = 0; turn < 10; ++turn) await page.mouse.wheel(0, -400);
  await page.keyboard.up("Control");
  await page.waitForFunction((most) => document.querySelectorAll("#step .chart svg path").length < most, before * 0.8);
});

look("numbers behind a chart are there as a table", async (page) => {
  await page.locator("#speed-up summary").click();
  await page.locator("#speed-up tbody tr").first().waitFor();
  const points = all("charts")[0].series.flatMap(({points}) => points);
  assert.equal(await page.locator("#speed-up tbody tr").count(), points.length);
});

look("the JSON can be saved", async (page) => {
  const [download] = await Promise.all([page.waitForEvent("download"), page.locator("#save").click()]);
  assert.equal(download.suggestedFilename(), "study-sample.json");
  assert.deepEqual(JSON.parse(readFileSync(await download.path(), "utf8")), report);
});

// Tooltips leave bold numbers behind, so not on the page that others have used.
test("hostile texts are texts", 1280, async (page) => {
  assert.equal(await page.locator("main b").count(), 0);
  assert.ok((await page.locator("#gaps h3").textContent()).includes("</script><b onclick"));
});

const background = (page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
const axisInk = (page) => page.locator("#growth .chart svg text").first().getAttribute("fill");

test("dark as the system asks, and by the button", 1280, async (page) => {
  const dark = [await background(page), await axisInk(page)];
  await picture(page, "desktop-dark");
  await page.locator("#theme").click();
  await painted(page);
  const light = [await background(page), await axisInk(page)];
  assert.notEqual(dark[0], light[0]);
  assert.notEqual(dark[1], light[1]);
  await page.locator("#theme").click();
  await painted(page);
  assert.deepEqual([await background(page), await axisInk(page)], dark);
}, "dark");

for (const scheme of ["light", "dark"]) {
  test(`a phone shows all of it, ${scheme}`, 380, async (page) => {
    const widest = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(widest <= 380, `${widest} pixels wide`);
    for (const {id} of all("charts")) {
      const {width} = await page.locator(`#${id} .chart svg`).boundingBox();
      assert.ok(width > 250 && width <= 380, `${id}: ${width} wide`);
    }
    await picture(page, `phone-${scheme}`);
  }, scheme);
}

test("prints light, within the paper", 1280, async (page) => {
  await page.emulateMedia({media: "print", colorScheme: "dark"});
  await page.waitForFunction(() => [...document.querySelectorAll(".chart svg")].every((svg) => svg.clientWidth <= 680));
  assert.equal(await background(page), "rgb(255, 255, 255)");
  await page.pdf({path: join(folder, "print.pdf"), format: "A4"});
  await page.setViewportSize({width: 688, height: 1000});
  await picture(page, "print");
}, "dark");

let failed = 0;
let sharedPage;
for (const {name, width, run, scheme, shared} of tests) {
  const page = shared && sharedPage ? sharedPage : await open(width, 900, scheme);
  if (shared) sharedPage = page;
  try {
    await run(page);
    assert.deepEqual(page.complaints, []);
    console.log(`passed: ${name}`);
  } catch (error) {
    ++failed;
    console.error(`FAILED: ${name}\n${error.stack}`);
  }
  if (!shared) await page.context().close();
}
await browser.close();
console.log(`${tests.length - failed} passed, ${failed} failed; pictures: ${folder}`);
process.exit(failed ? 1 : 0);
