#include "doublet/options/options.h"
#include "support/option_ranges.h"

#include <functional>

namespace doublet {
namespace {

enum class Weave { Plain, Twill };
inline constexpr std::array kWeaves{"plain", "twill"};

struct Plate {
  double heat = 150;
  static constexpr auto describe() {
    using namespace options;
    using O = Plate;
    return Description{"Plate", option(&O::heat, "heat", Range{0, 220, Open::Below}, "degrees", "of the sole")};
  }
};

struct Press {
  int strokes = 3;
  bool steam = true;
  Weave weave = Weave::Twill;
  std::string starch = "rice";
  std::vector<double> folds = {0.1, 0.25};
  std::vector<std::string> weaves = {"plain"};
  Plate plate;
  std::function<void()> on_stroke;
  static constexpr auto describe() {
    using namespace options;
    using O = Press;
    return Description{
        "Press",
        option(&O::strokes, "strokes", at_least(1), "", "of the plate"),
        option(&O::steam, "steam", "wet it first"),
        option(&O::weave, "weave", kWeaves, "of the cloth"),
        option(&O::starch, "starch", "by name"),
        option(&O::folds, "folds", above(0), "m", "where they lie"),
        option(&O::weaves, "weaves", kWeaves, "that are pressed alike"),
        option(&O::plate, "plate", "its own"),
        not_serialised(&O::on_stroke, "on_stroke", "called after each"),
    };
  }
  void validate() const {
    options::check(*this);
    if (strokes > 9 && !steam)
      options::throw_invalid("Press: strokes", "less than 10 without steam", std::to_string(strokes));
  }
};

// A description of fewer fields than that does not compile.
static_assert(options::detail::member_count<Press>() == 8 && options::detail::member_count<Plate>() == 1);

std::string refusal(const Press &press) {
  try {
    options::validate(press);
  } catch (const std::invalid_argument &error) {
    return error.what();
  }
  return "";
}

TEST(Options, RefusalsNameStructFieldRangeUnitAndValue) {
  expect_ranges<Press>();
  Press press;
  EXPECT_EQ(refusal(press), "");
  press.strokes = 0;
  EXPECT_EQ(refusal(press), "Press: strokes: expected a number of at least 1, found 0");
  press = {};
  press.folds = {0.1, -0.5};
  EXPECT_EQ(refusal(press), "Press: folds: expected a number above 0 m, found -0.5");
  press = {};
  press.plate.heat = 220.5;
  EXPECT_EQ(refusal(press), "Plate: heat: expected a number in (0, 220] degrees, found 220.5");
  press = {};
  press.weaves = {"plain", "knit"};
  EXPECT_EQ(refusal(press), "Press: weaves: expected one of 'plain', 'twill', found 'knit'");
  press = {};
  press.strokes = 12, press.steam = false;
  EXPECT_EQ(refusal(press), "Press: strokes: expected less than 10 without steam, found 12");
}

TEST(Options, AreListedWithNestedOnesButWithoutWhatIsNoOption) {
  using List = std::vector<std::pair<std::string, std::string>>;
  EXPECT_EQ(options::to_pairs(Press{}), (List{{"strokes", "3"},
                                              {"steam", "true"},
                                              {"weave", "twill"},
                                              {"starch", "'rice'"},
                                              {"folds", "(0.1, 0.25)"},
                                              {"weaves", "('plain')"},
                                              {"plate.heat", "150"}}));
}

TEST(Options, NumbersAreShownSoThatTheyReadBack) {
  EXPECT_EQ(options::to_text(1e-9), "1e-09");
  EXPECT_EQ(options::to_text(0.1), "0.1");
  EXPECT_EQ(options::to_text(1.0 / 3, 3), "0.333");
  EXPECT_EQ(options::to_text(1234567.8, 3), "1234568");
  EXPECT_EQ(options::to_text(-0.00012345, 2), "-0.00012");
  EXPECT_EQ(options::to_text(std::numeric_limits<double>::infinity(), 3), "inf");
}

TEST(Options, OneBitOfANumberChangesItsText) {
  Press press;
  press.plate.heat = std::nextafter(150, 151);
  EXPECT_NE(options::to_pairs(press), options::to_pairs(Press{}));
}

} // namespace
} // namespace doublet
