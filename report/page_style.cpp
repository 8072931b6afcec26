#include "report/page_parts.h"

namespace camber::report {

const std::string_view kPagePolicy =
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; img-src data: blob:\">\n";

const std::string_view kPageStyle = R"css(
:root { --ink: #1d2733; --soft: #5c6877; --line: #d9dfe6; --card: #ffffff; --page: #f2f4f7; --blue: #1668b8; }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink);
       font: 15px/1.45 system-ui, "Segoe UI", "DejaVu Sans", Arial, sans-serif; }
main { max-width: 1240px; margin: 0 auto; padding: 22px 20px 40px; }
h1 { font-size: 24px; margin: 0 0 2px; overflow-wrap: anywhere; }
h2 { font-size: 16px; margin: 0 0 10px; }
.sub { color: var(--soft); margin: 0 0 18px; overflow-wrap: anywhere; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(210px, 1fr)); gap: 12px; margin-bottom: 14px; }
.tile, .card { background: var(--card); border: 1px solid var(--line); border-radius: 8px; }
.tile { padding: 10px 14px; }
.tile .name { color: var(--soft); font-size: 13px; }
.tile .value { font-size: 23px; font-weight: 600; font-variant-numeric: tabular-nums; }
.tile .value small { font-size: 14px; font-weight: 400; color: var(--soft); }
.card { padding: 14px 16px; margin-bottom: 14px; }
.maps { display: grid; grid-template-columns: 1fr 1fr; gap: 12px; }
.maps.single { grid-template-columns: 1fr; }
.maps figure { margin: 0; }
.maps figcaption { font-weight: 600; margin-bottom: 4px; }
.maps canvas { width: 100%; height: 400px; display: block; border-radius: 6px; background: #e3e8ee; cursor: grab;
               touch-action: none; }
.bar { display: flex; flex-wrap: wrap; gap: 8px 18px; align-items: center; margin: 10px 0 0; color: var(--soft);
       font-size: 13px; }
.bar button { font: inherit; color: var(--ink); background: #f6f8fa; border: 1px solid var(--line); border-radius: 5px;
              padding: 3px 10px; cursor: pointer; }
.bar button[aria-pressed=true] { background: var(--blue); border-color: var(--blue); color: #fff; }
.legend { flex: 1 1 380px; min-width: 300px; }
.legend canvas { width: 100%; height: 38px; display: block; }
.read { min-height: 1.5em; font-variant-numeric: tabular-nums; color: var(--ink); font-size: 13px; margin-top: 6px; }
.two { display: grid; grid-template-columns: 1fr 1fr; gap: 14px; }
.two .card { margin-bottom: 14px; }
canvas.plot { width: 100%; height: 260px; display: block; }
.note { color: var(--soft); font-size: 13px; margin: 6px 0 0; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: right; padding: 4px 8px; border-bottom: 1px solid var(--line); }
th:first-child, td:first-child { text-align: left; }
th { font-weight: 600; color: var(--soft); font-size: 13px; }
ul { margin: 0; padding-left: 20px; }
@media (max-width: 820px) { .maps, .two { grid-template-columns: 1fr; } }
@media print { body { background: #fff; } .bar button { display: none; } .card { break-inside: avoid; } }
)css";

}  // namespace camber::report
