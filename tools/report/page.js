const report = JSON.parse(document.getElementById("report-json").textContent);
document.getElementById("report").textContent = report.summary;
