#include "host/image/channel_choice.h"

#include <algorithm>
#include <cctype>
#include <map>

namespace mica::host {
namespace {

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return text;
}

/// Channels of one layer: what precedes the last dot of their names, and by what follows it, in lower case.
struct Layer {
  std::string name;
  std::map<std::string, int> channels;

  bool has(const std::string& channel) const { return channels.count(channel) > 0; }
  std::vector<int> find(const std::vector<std::string>& wanted) const {
    std::vector<int> indices;
    for (const std::string& channel : wanted)
      if (has(channel)) indices.push_back(channels.at(channel));
    return indices.size() == wanted.size() ? indices : std::vector<int>{};
  }
};

std::vector<Layer> layers_of(const std::vector<std::string>& names, int alpha) {
  std::vector<Layer> layers;
  for (int n = 0; n < static_cast<int>(names.size()); ++n) {
    if (n == alpha) continue;
    const std::string name = lower_case(names[static_cast<std::size_t>(n)]);
    const std::size_t dot = name.rfind('.');
    const std::string layer = dot == name.npos ? "" : name.substr(0, dot);
    const auto found =
        std::find_if(layers.begin(), layers.end(), [&](const Layer& other) { return other.name == layer; });
    Layer& of = found == layers.end() ? layers.emplace_back(Layer{layer, {}}) : *found;
    of.channels.emplace(dot == name.npos ? name : name.substr(dot + 1), n);
  }
  return layers;
}

void add(std::vector<ChannelSet>* sets, const std::vector<int>& indices, int rank) {
  if (!indices.empty()) sets->push_back({indices, rank});
}

bool has_alpha_alone(const Layer& layer, std::size_t channels) {
  return layer.channels.size() - (layer.has("a") ? 1 : 0) == channels;
}

void add_maps(const Layer& layer, bool is_only_layer, std::vector<ChannelSet>* sets) {
  const bool normal = says_normal(layer.name), top = layer.name.empty();
  add(sets, layer.find({"x", "y", "z"}), normal ? 0 : 1);
  add(sets, layer.find({"r", "g", "b"}), normal ? 0 : top ? 2 : 3);
  if (has_alpha_alone(layer, 2))
    for (const auto& pair : {std::vector<std::string>{"x", "y"}, {"r", "g"}, {"u", "v"}})
      add(sets, layer.find(pair), normal ? 0 : 4);
  if (is_only_layer && has_alpha_alone(layer, 1) && !layer.has("a"))
    add(sets, {layer.channels.begin()->second}, 5);
}

/// Luminance beside chroma (RY, BY) or as the Y of X, Y, Z is no grey, and neither is a depth.
void add_colors(const Layer& layer, std::vector<ChannelSet>* sets) {
  const bool top = layer.name.empty();
  add(sets, layer.find({"r", "g", "b"}), top ? 0 : 1);
  const bool is_luminance = layer.has("y") && !layer.has("ry") && !layer.has("by") && !layer.has("x");
  if (is_luminance) add(sets, layer.find({"y"}), top ? 2 : 3);
  if (has_alpha_alone(layer, 1))
    for (const char* grey : {"r", "l", "i", "grey", "gray"}) add(sets, layer.find({grey}), top ? 2 : 3);
}

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> items;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    std::string item = list.substr(begin, end - begin);
    item.erase(std::remove(item.begin(), item.end(), ' '), item.end());
    items.push_back(item);
    begin = end + 1;
  }
  return items;
}

/// The channels of these names; empty when one is missing.
std::vector<int> find_names(const std::vector<std::string>& names, const std::vector<std::string>& wanted) {
  std::vector<int> indices;
  for (const std::string& name : wanted) {
    const auto found = std::find_if(names.begin(), names.end(), [&](const std::string& other) {
      return lower_case(other) == lower_case(name);
    });
    if (found == names.end()) return {};
    indices.push_back(static_cast<int>(found - names.begin()));
  }
  return indices;
}

}  // namespace

bool says_normal(const std::string& name) {
  const std::string text = lower_case(name);
  return text == "n" || text.find("normal") != text.npos;
}

std::vector<ChannelSet> fitting_channels(const std::vector<std::string>& names, int alpha, PictureUse use,
                                         const std::string& wanted) {
  std::vector<ChannelSet> sets;
  if (const std::vector<int> named = find_names(names, split(wanted)); !wanted.empty() && !named.empty()) {
    const bool fits = use == PictureUse::map ? named.size() <= 3 : named.size() == 3 || named.size() == 1;
    if (fits) sets.push_back({named, 0});
    return sets;
  }
  const std::vector<Layer> layers = layers_of(names, alpha);
  for (const Layer& layer : layers) {
    if (!wanted.empty() && layer.name != lower_case(wanted)) continue;
    if (use == PictureUse::map)
      add_maps(layer, layers.size() == 1, &sets);
    else
      add_colors(layer, &sets);
  }
  int best = 99;
  for (const ChannelSet& set : sets) best = std::min(best, set.rank);
  sets.erase(std::remove_if(sets.begin(), sets.end(), [&](const ChannelSet& set) { return set.rank > best; }),
             sets.end());
  return sets;
}

}  // namespace mica::host
