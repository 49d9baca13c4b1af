#include "overseer/web_callers.h"

#include <algorithm>
#include <iterator>
#include <map>

namespace aurasim::overseer {
namespace {

using Callers = std::vector<std::shared_ptr<WebCaller>>;

/// Returns the oldest connection of the address that has most. Null: there are none.
std::shared_ptr<WebCaller> oldest_of_the_greediest(const Callers& callers) {
  std::map<std::string, Callers> by_address;
  for (const auto& caller : callers) by_address[caller->address()].push_back(caller);
  const auto fewer = [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); };
  const auto greediest = std::max_element(by_address.begin(), by_address.end(), fewer);
  return greediest == by_address.end() ? nullptr : greediest->second.front();
}

/// Returns the connection to drop: a silent one if there is any, else one of all.
std::shared_ptr<WebCaller> whom_to_drop(const Callers& callers) {
  Callers silent;
  std::copy_if(callers.begin(), callers.end(), std::back_inserter(silent),
               [](const auto& c) { return c->is_silent(); });
  return oldest_of_the_greediest(silent.empty() ? callers : silent);
}

}  // namespace

bool WebCallers::enter(const std::shared_ptr<WebCaller>& caller) {
  forget_the_gone();
  const std::shared_ptr<WebCaller> leaving = whom_to_drop_for(caller->address());
  if (leaving) {
    std::erase_if(callers_, [&](const auto& known) { return known.lock() == leaving; });
    leaving->drop();
  }
  callers_.push_back(caller);
  return leaving != nullptr;
}

std::size_t WebCallers::count() {
  forget_the_gone();
  return callers_.size();
}

void WebCallers::forget_the_gone() {
  std::erase_if(callers_, [](const auto& caller) { return caller.expired(); });
}

/// Returns the connection to drop for a newcomer; null if there is room.
std::shared_ptr<WebCaller> WebCallers::whom_to_drop_for(const std::string& address) const {
  Callers all, own;
  for (const auto& known : callers_) {
    if (auto caller = known.lock()) all.push_back(std::move(caller));
  }
  std::copy_if(all.begin(), all.end(), std::back_inserter(own), [&](const auto& c) { return c->address() == address; });
  if (own.size() >= most_of_one_) return whom_to_drop(own);
  return all.size() >= most_ ? whom_to_drop(all) : nullptr;
}

}  // namespace aurasim::overseer
