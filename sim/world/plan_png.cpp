// Plans drawn as bitmaps. libpng reports errors by a jump; between its start and its landing there
// is nothing here that would have to be destroyed.
#include <png.h>

#include <csetjmp>
#include <cstring>
#include <string>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/world/plan.hpp"
#include "sim/world/plan_parts.hpp"

namespace hearsay::plan {
namespace {

constexpr std::uintmax_t png_bytes_max = 64ULL << 20;
constexpr std::size_t channels = 4;  // what all kinds of PNG are turned into: R, G, B, alpha

/// The bytes not yet read.
struct Source {
  std::string_view rest;
};
/// What libpng complained of, first.
struct Complaint {
  char text[120] = {};
};

void take(png_structp png, png_bytep out, std::size_t count) {
  auto* source = static_cast<Source*>(png_get_io_ptr(png));
  if (source->rest.size() < count) png_error(png, "the file is cut off");
  std::memcpy(out, source->rest.data(), count);
  source->rest.remove_prefix(count);
}

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto* complaint = static_cast<Complaint*>(png_get_error_ptr(png));
  std::size_t i = 0;
  for (; i + 1 < sizeof complaint->text && message[i] != '\0'; ++i) {
    complaint->text[i] = message[i] >= ' ' && message[i] <= '~' ? message[i] : '?';
  }
  complaint->text[i] = '\0';
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

/// Owns libpng's state; all of it is freed with it.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : source_{bytes} {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &complaint_, on_error, on_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  ~Reader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  /// The size, before any memory is taken for pixels; false for an error.
  bool header(png_uint_32& columns, png_uint_32& rows) {
    if (info_ == nullptr) return false;
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_read_fn(png_, &source_, take);
    png_set_user_limits(png_, side_max, side_max);
    // Colour profiles, texts and the like are skipped unread: some allocate what they claim to
    // hold.
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_read_info(png_, info_);
    columns = png_get_image_width(png_, info_);
    rows = png_get_image_height(png_, info_);
    png_set_expand(png_);
    png_set_scale_16(png_);
    png_set_gray_to_rgb(png_);
    png_set_add_alpha(png_, 0xff, PNG_FILLER_AFTER);
    png_read_update_info(png_, info_);
    return true;
  }
  std::size_t row_bytes() const { return png_get_rowbytes(png_, info_); }

  /// All pixels; false for an error.
  bool pixels(png_bytep* rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }

  std::string complaint() const { return complaint_.text; }

 private:
  Source source_;
  Complaint complaint_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

/// Luminance times 10,000 · 255, over white.
std::uint32_t luminance(const png_byte* pixel) {
  const std::uint32_t solid = 2126U * pixel[0] + 7152U * pixel[1] + 722U * pixel[2];
  return solid * pixel[3] + 10000U * 255U * (255U - pixel[3]);
}

}  // namespace

Drawing parse_png(std::string_view bytes, const std::string& name, double cell_m, int threshold) {
  parts::check_cell(cell_m, name);
  if (threshold < 1 || threshold > 255) {
    throw InputError(name, 0,
                     "a threshold of " + std::to_string(threshold) + "; 1 … 255 are allowed");
  }
  Reader reader(bytes);
  png_uint_32 columns = 0, rows = 0;
  if (!reader.header(columns, rows)) {
    throw InputError(
        name, 0,
        "no PNG of at most " + std::to_string(side_max) + " pixels a side: " + reader.complaint());
  }
  const std::size_t row_bytes = channels * columns;
  if (reader.row_bytes() != row_bytes) throw InputError(name, 0, "a kind of PNG that is not known");
  std::vector<png_byte> pixels(row_bytes * rows);
  std::vector<png_bytep> starts(rows);
  for (std::size_t line = 0; line < rows; ++line) {  // the first line at the top
    starts[line] = pixels.data() + (rows - 1 - line) * row_bytes;
  }
  if (!reader.pixels(starts.data())) {
    throw InputError(name, 0, "no whole PNG: " + reader.complaint());
  }
  Drawing drawing{.columns = static_cast<int>(columns),
                  .rows = static_cast<int>(rows),
                  .cell_m = cell_m,
                  .walls = std::vector<std::uint8_t>(std::size_t{columns} * rows),
                  .places = {}};
  const std::uint32_t bright = 10000U * 255U * static_cast<std::uint32_t>(threshold);
  for (std::size_t i = 0; i < drawing.walls.size(); ++i) {
    drawing.walls[i] = luminance(pixels.data() + channels * i) < bright;
  }
  parts::check_free(drawing, name);
  return drawing;
}

Drawing read_png(const std::string& file, double cell_m, int threshold) {
  return parse_png(parts::content_of(file, png_bytes_max), file, cell_m, threshold);
}

}  // namespace hearsay::plan
