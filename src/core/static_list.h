// The statics of a scene, packed: some 32 bytes for one without a name, path or belt, where a StaticBody has 200.
// Copies of a list share what they have in common, so a process that copies its scene has its statics once.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/static_body.h"

namespace aurasim::core {

/// Grows at its end. Statics are returned by value, with every bit that they were added with. Several threads may use
/// copies of one list at once.
class StaticList {
 public:
  class Iterator;

  StaticList() = default;
  StaticList(std::initializer_list<StaticBody> statics);

  std::size_t size() const { return full_.size() * kOfBlock + last_.records.size(); }
  bool empty() const { return size() == 0; }
  /// Precondition of all functions with an index: index < size().
  StaticBody at(std::size_t index) const;
  /// Const, so that a change of the copy does not compile: see change().
  const StaticBody operator[](std::size_t index) const { return at(index); }  // NOLINT(readability-const-return-type)
  StaticBody back() const { return at(size() - 1); }
  Iterator begin() const;
  Iterator end() const;

  /// Parts of a static, without making the whole of it.
  std::uint32_t shape(std::size_t index) const;
  Pose pose(std::size_t index) const;
  bool moves(std::size_t index) const;

  /// The first static of this name; nothing if there is none.
  std::optional<std::size_t> find(std::string_view name) const;
  /// The name of a static that is given none.
  static std::string usual_name(std::size_t index);
  /// The static whose usual name this is, if it has that name.
  std::optional<std::size_t> find_usual(std::string_view name) const;

  void push_back(const StaticBody& body);
  void clear() { *this = {}; }
  /// Replaces a static. For scenes that are made by hand: it costs as much as some thousand calls of push_back().
  void set(std::size_t index, const StaticBody& body);
  /// Replaces a static by what `change(StaticBody&)` makes of it. Costs as much as set().
  template <class Change>
  void change(std::size_t index, Change&& change) {
    StaticBody body = at(index);
    std::forward<Change>(change)(body);
    set(index, body);
  }

 private:
  static constexpr std::size_t kOfBlock = 1024;

  /// Shape, material and rotation, which many statics have in common.
  struct Kind {
    std::uint32_t shape = 0;
    std::uint32_t material = 0;
    Quat q_WB;
  };
  struct Record {
    Vec3 p_WB;
    std::uint16_t kind = 0;  ///< index in Block::kinds
  };
  struct Name {
    std::uint16_t of = 0;   ///< index in Block::records
    std::uint32_t end = 0;  ///< in Block::names; begins where the one before ends
  };
  struct Motion {
    std::uint16_t of = 0;
    std::optional<StaticPath> path;
    Vec3 belt_S;
  };
  struct Block {
    std::vector<Record> records;
    std::vector<Kind> kinds;
    std::vector<Name> named;  ///< ascending `of`; the others have their usual names
    std::string names;
    std::vector<Motion> moving;  ///< ascending `of`
  };

  std::pair<const Block&, std::size_t> place_of(std::size_t index) const;
  static std::uint16_t kind_of(const StaticBody& body, Block& block);

  std::vector<std::shared_ptr<const Block>> full_;  ///< kOfBlock statics each; never changed
  Block last_;                                      ///< fewer
};

class StaticList::Iterator {
 public:
  using value_type = StaticBody;
  using difference_type = std::ptrdiff_t;
  using iterator_concept = std::input_iterator_tag;

  Iterator() = default;
  Iterator(const StaticList& list, std::size_t index) : list_(&list), index_(index) {}

  StaticBody operator*() const { return list_->at(index_); }
  Iterator& operator++() {
    ++index_;
    return *this;
  }
  Iterator operator++(int) {
    const Iterator before = *this;
    ++index_;
    return before;
  }
  bool operator==(const Iterator& other) const { return index_ == other.index_; }

 private:
  const StaticList* list_ = nullptr;
  std::size_t index_ = 0;
};

inline StaticList::Iterator StaticList::begin() const { return {*this, 0}; }
inline StaticList::Iterator StaticList::end() const { return {*this, size()}; }

}  // namespace aurasim::core
