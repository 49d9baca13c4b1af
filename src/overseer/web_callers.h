// Who asks by HTTP. So many connections and no more, and so many of one address; when all are taken, a newcomer gets
// the place of one that keeps its request waiting: whoever opens connections and says nothing shuts out himself, and no
// page.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace aurasim::overseer {

/// One connection.
class WebCaller {
 public:
  explicit WebCaller(std::string address) : address_(std::move(address)) {}
  virtual ~WebCaller() = default;
  WebCaller(const WebCaller&) = delete;
  WebCaller& operator=(const WebCaller&) = delete;

  /// Ends it, whatever it does.
  virtual void drop() = 0;

  const std::string& address() const { return address_; }
  /// Its next request has not come, or not the whole header of it.
  bool is_silent() const { return is_silent_; }

 protected:
  void set_silent(bool silent) { is_silent_ = silent; }

 private:
  std::string address_;
  bool is_silent_ = true;
};

/// Used by one thread.
class WebCallers {
 public:
  WebCallers(std::size_t most, std::size_t most_of_one) : most_(most), most_of_one_(most_of_one) {}

  /// Takes it in. Returns whether another one was dropped for it: the oldest silent one of the address that has most of
  /// them; if all have asked, the oldest of the address that has most. One of its own address, if it is that which has
  /// no more places.
  bool enter(const std::shared_ptr<WebCaller>& caller);
  std::size_t count();

 private:
  void forget_the_gone();
  std::shared_ptr<WebCaller> whom_to_drop_for(const std::string& address) const;

  std::size_t most_;
  std::size_t most_of_one_;                        ///< address
  std::vector<std::weak_ptr<WebCaller>> callers_;  ///< in the order in which they came
};

}  // namespace aurasim::overseer
