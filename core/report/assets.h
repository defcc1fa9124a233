// The files a report is made of, embedded in the library at build time (assets.cc.in).

#ifndef IDIM_CORE_REPORT_ASSETS_H_
#define IDIM_CORE_REPORT_ASSETS_H_

#include <string_view>

namespace idim::report_assets {

std::string_view Template();        // report.html, with {{name}} where RenderReport puts text
std::string_view Style();           // report.css
std::string_view Script();          // report.js
std::string_view Echarts();         // echarts.min.js
std::string_view EchartsLicense();  // the licence text that Apache-2.0 asks every copy to carry
std::string_view EchartsNotice();
std::string_view D3License();  // of the parts of d3 inside ECharts

}  // namespace idim::report_assets

#endif  // IDIM_CORE_REPORT_ASSETS_H_
