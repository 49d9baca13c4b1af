// Limits the connections that ask by HTTP, in all and for each address. When all places are taken, a newcomer replaces
// a connection that keeps its request waiting. So a client that opens connections and sends nothing shuts out only
// itself.
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

  /// Ends the connection, whatever it is doing.
  virtual void drop() = 0;

  const std::string& address() const { return address_; }
  /// True while the header of its next request has not completely arrived.
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

  /// Admits a connection. Returns whether another one was dropped for it: the oldest silent one of the address that has
  /// most of these, or if none is silent, the oldest one of the address that has most. If the newcomer's own address
  /// has no more places, one of that address is dropped.
  bool enter(const std::shared_ptr<WebCaller>& caller);
  std::size_t count();

 private:
  void forget_the_gone();
  std::shared_ptr<WebCaller> whom_to_drop_for(const std::string& address) const;

  std::size_t most_;
  std::size_t most_of_one_;                        ///< most connections of one address
  std::vector<std::weak_ptr<WebCaller>> callers_;  ///< connections in order of arrival
};

}  // namespace aurasim::overseer
