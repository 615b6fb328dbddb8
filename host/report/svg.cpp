#include "host/report/svg.h"

#include <fmt/format.h>

#include <utility>

namespace mica::host {
namespace {

std::string dash(bool dashed) {
  return dashed ? " stroke-dasharray=\"4 3\"" : "";
}

/// Closed outline around the origin, of radius 1.
std::vector<std::pair<double, double>> outline(Marker marker) {
  switch (marker) {
    case Marker::square:
      return {{-0.85, -0.85}, {0.85, -0.85}, {0.85, 0.85}, {-0.85, 0.85}};
    case Marker::diamond:
      return {{0, -1.25}, {1.1, 0}, {0, 1.25}, {-1.1, 0}};
    case Marker::up:
      return {{0, -1.15}, {1.1, 0.85}, {-1.1, 0.85}};
    case Marker::down:
      return {{0, 1.15}, {1.1, -0.85}, {-1.1, -0.85}};
    case Marker::cross:
      return {{-1, -0.6}, {-0.6, -1}, {0, -0.4}, {0.6, -1}, {1, -0.6}, {0.4, 0},
              {1, 0.6},   {0.6, 1},   {0, 0.4},  {-0.6, 1}, {-1, 0.6}, {-0.4, 0}};
    case Marker::plus:
      return {{-0.35, -1.1}, {0.35, -1.1}, {0.35, -0.35}, {1.1, -0.35}, {1.1, 0.35},   {0.35, 0.35},
              {0.35, 1.1},   {-0.35, 1.1}, {-0.35, 0.35}, {-1.1, 0.35}, {-1.1, -0.35}, {-0.35, -0.35}};
    case Marker::bar:
      return {{-1.2, -0.4}, {1.2, -0.4}, {1.2, 0.4}, {-1.2, 0.4}};
    case Marker::circle:
      break;
  }
  return {};
}

}  // namespace

std::string escape_markup(const std::string& text) {
  std::string escaped;
  for (const char letter : text) {
    switch (letter) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += letter;
    }
  }
  return escaped;
}

Svg::Svg(double width, double height) : width_(width), height_(height) {}

void Svg::shape(const std::string& element, const std::string& tooltip) {
  if (tooltip.empty())
    body_ += element + "/>\n";
  else
    body_ += fmt::format("{0}><title>{2}</title></{1}>\n", element, element.substr(1, element.find(' ') - 1),
                         escape_markup(tooltip));
}

void Svg::line(double x1, double y1, double x2, double y2, const std::string& color, double width,
               bool dashed) {
  shape(fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
                    "stroke-width=\"{}\"{}",
                    x1, y1, x2, y2, color, width, dash(dashed)),
        "");
}

void Svg::polyline(const std::vector<std::pair<double, double>>& points, const std::string& color,
                   double width, bool dashed) {
  std::string places;
  for (const auto& [x, y] : points) places += fmt::format("{:.1f},{:.1f} ", x, y);
  shape(fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" "
                    "stroke-linejoin=\"round\"{}",
                    places, color, width, dash(dashed)),
        "");
}

void Svg::rectangle(double x, double y, double width, double height, const std::string& color,
                    const std::string& tooltip) {
  shape(fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"", x, y,
                    width, height, color),
        tooltip);
}

void Svg::marker(Marker marker, double x, double y, double radius, const std::string& color,
                 const std::string& tooltip) {
  const std::string paint = fmt::format("fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"0.8\"", color);
  if (marker == Marker::circle) {
    shape(fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" {}", x, y, radius, paint), tooltip);
    return;
  }
  std::string places;
  for (const auto& [dx, dy] : outline(marker))
    places += fmt::format("{:.1f},{:.1f} ", x + radius * dx, y + radius * dy);
  shape(fmt::format("<polygon points=\"{}\" {}", places, paint), tooltip);
}

void Svg::text(double x, double y, const std::string& text, Anchor anchor, double size,
               const std::string& color, bool upwards) {
  constexpr const char* anchors[] = {"start", "middle", "end"};
  const std::string turn = upwards ? fmt::format(" transform=\"rotate(-90 {:.1f} {:.1f})\"", x, y) : "";
  body_ += fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" font-size=\"{}\" fill=\"{}\"{}>{}</text>\n", x, y,
      anchors[static_cast<int>(anchor)], size, color, turn, escape_markup(text));
}

std::string Svg::str() const {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "role=\"img\">\n{2}</svg>\n",
      width_, height_, body_);
}

}  // namespace mica::host
