#pragma once

#include <string>
#include <vector>

namespace mica::host {

/// Text for HTML and SVG: & < > " ' replaced.
std::string escape_markup(const std::string& text);

enum class Marker { circle, square, diamond, up, down, cross, plus, bar };

enum class Anchor { start, middle, end };

/// A drawing that stands inside a page. Lengths are in pixels, y runs down, colours are "#rrggbb".
class Svg {
 public:
  Svg(double width, double height);

  void line(double x1, double y1, double x2, double y2, const std::string& color, double width,
            bool dashed = false);
  void polyline(const std::vector<std::pair<double, double>>& points, const std::string& color, double width,
                bool dashed = false);
  void rectangle(double x, double y, double width, double height, const std::string& color,
                 const std::string& tooltip = "");
  /// @param tooltip shown by browsers when the pointer rests on it.
  void marker(Marker marker, double x, double y, double radius, const std::string& color,
              const std::string& tooltip = "");
  void text(double x, double y, const std::string& text, Anchor anchor = Anchor::start, double size = 11,
            const std::string& color = "#444444", bool upwards = false);

  std::string str() const;

 private:
  void shape(const std::string& element, const std::string& tooltip);

  double width_, height_;
  std::string body_;
};

}  // namespace mica::host
