// Bundles the page with the chart library into one HTML text, and writes that as a C++ source.
//   node build.mjs MODULES OUTPUT    MODULES: the folder into which npm put its packages
import {readFileSync, writeFileSync} from "node:fs";
import {createRequire} from "node:module";
import {join} from "node:path";

const [modules, output] = process.argv.slice(2);
const packages = join(modules, "node_modules");
const esbuild = createRequire(join(modules, "package.json"))("esbuild");

function bundle(entry) {
  const {outputFiles} = esbuild.buildSync({
    entryPoints: [entry],
    nodePaths: [packages],
    bundle: true,
    minify: true,
    write: false,
    format: "iife",
    target: "es2020",
    legalComments: "none", // licences() has them in full
    define: {"process.env.NODE_ENV": '"production"'},
  });
  return outputFiles[0].text.trim();
}

// Of all that goes into the page; their texts ask to go with it.
function licences() {
  const files = ["echarts/NOTICE", "echarts/LICENSE", "echarts/licenses/LICENSE-d3", "zrender/LICENSE",
    "tslib/LICENSE.txt"];
  return files.map((file) => `${file}\n\n${readFileSync(join(packages, file), "utf8").trim()}`).join("\n\n\n");
}

const escaped = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;");
const version = JSON.parse(readFileSync(join(packages, "echarts/package.json"), "utf8")).version;
const parts = {
  style: bundle("page.css").replace(/<\/style/gi, "<\\/style"),
  script: bundle("page.js").replace(/<\/script/gi, "<\\/script").replace(/<!--/g, "<\\!--"),
  licences: escaped(licences()),
  chart_library: `Apache ECharts ${version}`,
};
const page = readFileSync("page.html", "utf8")
  .replace(/@(style|script|licences|chart_library)@/g, (_, part) => parts[part]);
for (const mark of ["@report_title@", "@report_json@"]) {
  if (page.split(mark).length !== 2) throw new Error(`page.html must hold ${mark} once`);
}

// Compilers take string literals of any length, but not in one piece what would be the end of a raw one.
const delimiter = "page";
if (page.includes(`)${delimiter}"`)) throw new Error(`the page holds the end of a C++ literal: )${delimiter}"`);
writeFileSync(output, `#include "study/report_page.hpp"

namespace {
constexpr char kText[] = R"${delimiter}(${page.replace(/\r/g, "")})${delimiter}";
}

const std::string_view sweepgrid::study::kReportPage(kText, sizeof(kText) - 1);
`);
