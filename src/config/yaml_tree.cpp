#include "config/yaml_tree.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <istream>
#include <sstream>
#include <streambuf>
#include <system_error>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include "config/packed_nodes.h"
#include "config/utf8.h"

namespace aurasim::config {
namespace {

constexpr std::string_view kCannotOpen = "it cannot be opened for reading";

/// A construct of YAML that is refused here.
struct RefusedYaml {
  YAML::Mark mark;
  std::string message;
};

std::size_t count_nodes(const YamlNode& node) {
  std::size_t count = 1 + (node.packed ? node.packed->count() : 0);
  for (const YamlNode& child : node.children) count += count_nodes(child);
  return count;
}

/// Builds the tree from the parser's events. Aliases become copies; every copy counts against the limit.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(const Place& at, std::span<const std::string_view> long_lists) : at_(at), long_lists_(long_lists) {}

  YamlNode take() { return std::move(root_); }
  const YAML::Mark& start() const { return start_; }

  void OnDocumentStart(const YAML::Mark& mark) override { start_ = mark; }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    put(started(YamlNode::Kind::kNothing, mark, anchor));
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    Open open = started(YamlNode::Kind::kText, mark, anchor);
    open.node.text = value;
    open.node.quoted = tag != "?" && !tag.empty();
    put(std::move(open));
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) throw RefusedYaml{mark, "an alias inside the value that it names"};
    count(count_nodes(found->second), mark);
    put({found->second, mark, YAML::NullAnchor, false});
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open_.push_back(started(YamlNode::Kind::kList, mark, anchor));
  }
  void OnSequenceEnd() override { close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open_.push_back(started(YamlNode::Kind::kMap, mark, anchor));
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    YamlNode node;
    YAML::Mark mark;
    YAML::anchor_t anchor = YAML::NullAnchor;
    bool has_key = false;  ///< for a map: the last child waits for its value
  };

  Place place_of(const YAML::Mark& mark) const {
    if (at_.line == 0) return at_;
    return {at_.source, mark.line + 1, mark.column + 1};
  }

  void count(std::size_t nodes, const YAML::Mark& mark) {
    nodes_ += nodes;
    if (nodes_ > kMostYamlNodes) {
      throw RefusedYaml{mark, fmt::format("more than {} values, aliases expanded", kMostYamlNodes)};
    }
  }

  Open started(YamlNode::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
    count(1, mark);
    Open open;
    open.node.kind = kind;
    open.node.place = place_of(mark);
    open.mark = mark;
    open.anchor = anchor;
    return open;
  }

  void close() {
    Open done = std::move(open_.back());
    open_.pop_back();
    put(std::move(done));
  }

  void put(Open done) {
    if (done.anchor != YAML::NullAnchor) {
      count(count_nodes(done.node), done.mark);
      anchors_[done.anchor] = done.node;
    }
    if (open_.empty()) {
      root_ = std::move(done.node);
    } else if (open_.back().node.kind == YamlNode::Kind::kList) {
      put_in_list(open_.back().node, std::move(done.node));
    } else {
      put_in_map(open_.back(), std::move(done));
    }
  }

  void put_in_list(YamlNode& list, YamlNode entry) {
    if (is_in_long_list()) {
      if (!list.packed) list.packed = std::make_shared<PackedNodes>(at_.source);
      list.packed->add(entry);
    } else {
      list.children.push_back(std::move(entry));
    }
  }

  /// True if the innermost open node is the value of a key in long_lists_.
  bool is_in_long_list() const {
    if (open_.size() != 2 || !open_.front().has_key) return false;
    return std::ranges::find(long_lists_, open_.front().node.children.back().key) != long_lists_.end();
  }

  void put_in_map(Open& map, Open done) {
    map.has_key = !map.has_key;
    if (map.has_key) {
      if (done.node.kind != YamlNode::Kind::kText) throw RefusedYaml{done.mark, "a key that is not text"};
      YamlNode entry;
      entry.key = std::move(done.node.text);
      entry.key_place = done.node.place;
      map.node.children.push_back(std::move(entry));
      return;
    }
    YamlNode& entry = map.node.children.back();
    // A missing value has no place of its own: the parser notices it only at the next token.
    if (done.node.kind == YamlNode::Kind::kNothing) done.node.place = entry.key_place;
    done.node.key = std::move(entry.key);
    done.node.key_place = entry.key_place;
    entry = std::move(done.node);
  }

  Place at_;
  std::span<const std::string_view> long_lists_;
  YAML::Mark start_;
  YamlNode root_;
  std::vector<Open> open_;
  std::unordered_map<YAML::anchor_t, YamlNode> anchors_;
  std::size_t nodes_ = 0;
};

void add_syntax_error(const Place& at, const YAML::Mark& mark, std::string_view message, Errors& errors) {
  Place place = at;
  if (at.line != 0 && !mark.is_null()) place = {at.source, mark.line + 1, mark.column + 1};
  errors.add(place, "", fmt::format("found {}, allowed: one YAML document", message));
}

void add_unprintable(const Place& place, char found, Errors& errors) {
  const auto byte = static_cast<unsigned char>(found);
  errors.add(place, "", fmt::format("found the byte 0x{:02x}, allowed: printable text in UTF-8", byte));
}

/// Refuses control characters and broken UTF-8 before the parser sees them, because it takes some for the end. Returns
/// the number of bytes without blanks and line ends at the end, or nothing. yaml-cpp 0.7 closes an open quote before
/// the last line end by itself.
std::optional<std::size_t> check_text(std::istream& in, const Place& at, Errors& errors) {
  std::size_t begin = 0, end = 0;
  Place place = at;
  for (std::string line; std::getline(in, line); begin += line.size() + 1, ++place.line) {
    if (const std::size_t bad = first_unprintable(line); bad < line.size()) {
      place.column = static_cast<int>(bad + 1);
      add_unprintable(at.line == 0 ? at : place, line[bad], errors);
      return std::nullopt;
    }
    if (const std::size_t last = line.find_last_not_of(" \t\r"); last != std::string::npos) end = begin + last + 1;
  }
  return end;
}

/// The first bytes of a stream.
class FirstBytes : public std::streambuf {
 public:
  FirstBytes(std::istream& in, std::size_t count) : in_(in), left_(count) {}

 protected:
  int_type underflow() override {
    in_.read(buffer_.data(), static_cast<std::streamsize>(std::min(left_, buffer_.size())));
    const std::streamsize count = in_.gcount();
    if (count == 0) return traits_type::eof();  // and what was read stays, because yaml-cpp puts the first bytes back
    left_ -= static_cast<std::size_t>(count);
    setg(buffer_.data(), buffer_.data(), buffer_.data() + count);
    return traits_type::to_int_type(buffer_[0]);
  }

 private:
  std::istream& in_;
  std::size_t left_;
  std::array<char, 1 << 14> buffer_;
};

/// Parses one YAML document. `in` is read twice.
std::optional<YamlNode> parse(std::istream& in, const Place& at, std::span<const std::string_view> long_lists,
                              Errors& errors) {
  const std::optional<std::size_t> bytes = check_text(in, at, errors);
  if (!bytes) return std::nullopt;
  in.clear();
  in.seekg(0);
  FirstBytes first(in, *bytes);
  std::istream text(&first);
  try {
    YAML::Parser parser(text);
    TreeBuilder builder(at, long_lists);
    const bool has_document = parser.HandleNextDocument(builder);
    YamlNode root = builder.take();
    if (!has_document) root.place = at;
    TreeBuilder rest(at, {});
    if (parser.HandleNextDocument(rest)) {
      add_syntax_error(at, rest.start(), "a second document", errors);
      return std::nullopt;
    }
    return root;
  } catch (const RefusedYaml& refused) {
    add_syntax_error(at, refused.mark, refused.message, errors);
  } catch (const YAML::Exception& wrong) {
    add_syntax_error(at, wrong.mark, wrong.msg, errors);
  } catch (const std::exception& wrong) {
    add_syntax_error(at, YAML::Mark::null_mark(), wrong.what(), errors);
  }
  return std::nullopt;
}

/// A readable regular file of at most `limit` bytes, and its size; otherwise nothing, and the reason in `why`.
std::optional<std::pair<std::ifstream, std::uintmax_t>> opened(const std::filesystem::path& file, std::uintmax_t limit,
                                                               std::string& why) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) {
    why = error ? error.message() : "No such file or directory";
  } else if (std::filesystem::is_directory(status)) {
    why = "it is a directory";
  } else if (!std::filesystem::is_regular_file(status)) {
    why = "it is not a regular file";
  } else if (const auto size = std::filesystem::file_size(file, error); error || size > limit) {
    why = error ? error.message() : fmt::format("it has {} bytes, at most {} are read", size, limit);
  } else if (std::ifstream in(file, std::ios::binary); in) {
    return std::pair(std::move(in), size);
  } else {
    why = kCannotOpen;
  }
  return std::nullopt;
}

}  // namespace

const YamlNode* YamlNode::find(std::string_view wanted_key) const {
  if (kind != Kind::kMap) return nullptr;
  const auto found =
      std::find_if(children.begin(), children.end(), [&](const YamlNode& child) { return child.key == wanted_key; });
  return found == children.end() ? nullptr : &*found;
}

YamlNode* YamlNode::find(std::string_view wanted_key) {
  return const_cast<YamlNode*>(std::as_const(*this).find(wanted_key));
}

std::size_t YamlNode::size() const { return packed ? packed->size() : children.size(); }

YamlNode& YamlNode::entry(std::size_t index) {
  if (!packed) return children[index];
  if (packed.use_count() > 1) packed = std::make_shared<PackedNodes>(*packed);
  return packed->unpacked(index);
}

std::optional<std::string> read_bytes(const std::filesystem::path& file, std::uintmax_t limit, std::string& why) {
  std::optional in = opened(file, limit, why);
  if (!in) return std::nullopt;
  std::string bytes(in->second, '\0');
  if (in->first.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) return bytes;
  why = kCannotOpen;
  return std::nullopt;
}

bool can_be_read(const std::filesystem::path& file, std::uintmax_t limit, std::string& why) {
  return opened(file, limit, why).has_value();
}

std::optional<YamlNode> parse_yaml(const std::string& text, const Place& at, Errors& errors) {
  std::istringstream in(text);
  return parse(in, at, {}, errors);
}

std::optional<YamlNode> read_yaml(const std::filesystem::path& file, Errors& errors,
                                  std::span<const std::string_view> long_lists) {
  const Place at{errors.add_source(file.string()), 1, 1};
  std::string why;
  std::optional in = opened(file, kLargestFileBytes, why);
  if (!in) {
    errors.add(at, "", fmt::format("found nothing to read: {}, allowed: a YAML file", why));
    return std::nullopt;
  }
  return parse(in->first, at, long_lists, errors);
}

}  // namespace aurasim::config
