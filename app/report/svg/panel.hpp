// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dampline::app::svg {

/// Colours by their names in the page's style sheet, which has them for light, dark and paper.
enum class Ink : std::uint8_t { kBlue, kOrange, kGreen, kPink, kGrey };

struct Point {
  double x{0.0};
  double y{0.0};
};
/// In a line: nothing joins what is before and after it.
inline constexpr Point kBreak{std::numeric_limits<double>::quiet_NaN(), 0.0};

struct Box {
  double left{0.0};
  double right{0.0};
  double bottom{0.0};
  double top{0.0};
};

struct Stroke {
  Ink ink{Ink::kBlue};
  double width{2.0};
  bool dashed{false};
};

/// A row of a panel that has rows instead of a vertical axis.
struct Lane {
  std::string name;
  std::string note;  ///< at the right end
};
/// Half the height of a bar in a lane, in lanes.
inline constexpr double kLaneHalf = 0.2;

struct Axis {
  std::string label;
  std::optional<double> low{};  ///< absent: from the data
  std::optional<double> high{};
  bool log{false};
  bool numbers{true};
};

/// One pair of axes with what is drawn in it. What the texts say is escaped; what is not finite is
/// not drawn.
class Panel {
 public:
  static constexpr double kHeight = 230.0;  ///< between the axes; the panel is 420 wide

  Panel(Axis x, Axis y, double height = kHeight);
  /// Row i is y = i, from the top.
  Panel(Axis x, std::vector<Lane> lanes);

  void title(std::string text) { title_ = std::move(text); }
  /// Empty `name`: not in the legend.
  void line(std::vector<Point> points, const Stroke& stroke, std::string name = "");
  /// Between two lines of as many points.
  void band(const std::vector<Point>& lower, const std::vector<Point>& upper, Ink ink,
            std::string name = "");
  void boxes(const std::vector<Box>& boxes, Ink ink, double opacity = 0.5, std::string name = "");
  void dots(std::vector<Point> points, Ink ink, double radius, std::string name = "");
  /// A stretch of the horizontal axis.
  void zone(double from, double to, std::string name);
  /// A line from the bottom to that share of the height, with its name beside it.
  void flag(double x, double share, std::string name);

  /// An <svg> element; `id` and `what` tell it from the others of the page.
  [[nodiscard]] std::string draw(const std::string& id, std::string_view what) const;
  /// The numbers behind the drawing as a JSON object, for plots.js: axes with their ranges, marks
  /// with their points. Holds no '<', whatever the names say.
  [[nodiscard]] std::string data() const;

 private:
  enum class Shape : std::uint8_t { kLine, kArea, kBoxes, kDots };
  struct Mark {
    Shape shape{Shape::kLine};
    std::vector<Point> points;
    Stroke stroke;
    double opacity{1.0};
    std::string name;
  };
  struct Flag {
    double x{0.0};
    double share{0.0};
    std::string name;
  };
  struct Frame;  // where everything is on the drawing

  [[nodiscard]] Frame frame() const;
  [[nodiscard]] std::string legend(const Frame& frame) const;
  [[nodiscard]] std::string axes(const Frame& frame) const;
  [[nodiscard]] std::string lanes(const Frame& frame) const;
  [[nodiscard]] std::string marks(const Frame& frame) const;
  [[nodiscard]] static std::string path_of(const Mark& mark, const Frame& frame);
  /// Of a mark's numbers; `places` are the x of the marks before it, to which a number refers.
  [[nodiscard]] std::string points_of(const Mark& mark, const Frame& frame,
                                      std::vector<std::string>& places) const;
  [[nodiscard]] static std::string boxes_path(const Mark& mark, const Frame& frame);
  [[nodiscard]] std::string flags(const Frame& frame) const;
  [[nodiscard]] std::string alternative(const Frame& frame, std::string_view what) const;

  Axis x_;
  Axis y_;
  std::vector<Lane> lanes_;
  double height_;
  std::string title_;
  std::vector<Mark> marks_;
  std::optional<Mark> zone_;
  std::vector<Flag> flags_;
};

}  // namespace dampline::app::svg
