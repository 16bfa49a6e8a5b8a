// Coming on the stage, and finding who is on it.
#include "server/aura/adaptive/outlook/stage.h"

#include <algorithm>
#include <numeric>

#include "server/base/merge_in.h"

namespace aureole {

void Stage::begin(const MigrationSituation& situation) {
  situation_ = &situation;
  bodies_.clear();
  auras_.clear();
  boxes_.clear();
  for (const Sleepers::Place place : admitted_) number_of_sleeper_[place] = none;
  admitted_.clear();
  ascending_.clear();
  number_in_slot_.clear();
  touching_of_.clear();
  touching_.clear();
}

void Stage::add(const HostedBody& body, const AuraCapsule& aura) {
  const std::uint32_t number = size();
  bodies_.push_back(&body);
  auras_.push_back(aura);
  boxes_.push_back(aura.box());
  if (!body.asleep || situation_->sleepers == nullptr) return;
  // It sleeps, and something is to happen with it.
  if (const auto place = situation_->sleepers->place_of(body.id)) {
    number_at(*place) = number;
    admitted_.push_back(*place);
  }
}

std::uint32_t& Stage::number_at(Sleepers::Place place) {
  if (number_of_sleeper_.size() <= place) number_of_sleeper_.resize(place + 1, none);
  return number_of_sleeper_[place];
}

void Stage::add_sleepers_beyond() {
  if (situation_->sleepers == nullptr) return;
  const std::span<const Sleepers::Place> beyond = situation_->sleepers->beyond();
  for (const Sleepers::Place place : beyond) situation_->sleepers->fetch(place);
  for (const Sleepers::Place place : beyond) admit(place);
}

/// Its number, whether it has been here before or not.
std::uint32_t Stage::admit(Sleepers::Place place) {
  std::uint32_t& number = number_at(place);
  if (number != none) return number;
  number = size();
  admitted_.push_back(place);
  const Sleepers& sleepers = *situation_->sleepers;
  bodies_.push_back(&sleepers.body(place));
  auras_.push_back(sleepers.aura(place));
  boxes_.push_back(sleepers.box(place));
  return number;
}

void Stage::set_aura(std::uint32_t number, const AuraCapsule& aura) {
  auras_[number] = aura;
  boxes_[number] = aura.box();
}

void Stage::sort_boxes() {
  rows_.build(boxes_);
  sorted_ = size();
}

void Stage::find(const AuraBox& box, std::vector<std::uint32_t>& found) {
  const RoughBox asked = RoughBox::around(box);  // A copy: the box may be of somebody on the stage.
  hits_.clear();
  if (situation_->sleepers != nullptr) find_sleepers(asked);
  // What comes of a look must not depend on who sleeps where.
  auto sleeper = hits_.begin();
  rows_.find_each(asked, [&](const BoxRows::Hit& hit) {
    for (; sleeper != hits_.end() && sleeper->place < hit.place; ++sleeper)
      found.push_back(admit(sleeper->sleeper));
    found.push_back(hit.number);
  });
  for (; sleeper != hits_.end(); ++sleeper) found.push_back(admit(sleeper->sleeper));
}

/// Those that the decision is shown and that the sorted boxes do not hold.
void Stage::find_sleepers(const RoughBox& asked) {
  const View* view = situation_->view;
  const auto is_shown = [&](const RoughBox& sleeper) {
    return view == nullptr || view->holds((sleeper.low[0] + sleeper.high[0]) / 2,
                                          (sleeper.low[2] + sleeper.high[2]) / 2);
  };
  situation_->sleepers->rows().find_each(asked, [&](const BoxRows::Hit& hit) {
    const std::uint32_t number = number_at(hit.number);
    if ((number == none || number >= sorted_) && is_shown(hit.box)) {
      if (number == none) situation_->sleepers->fetch(hit.number);
      hits_.push_back({hit.number, hit.place});
    }
  });
}

std::optional<std::uint32_t> Stage::number_of(BodyId id) {
  if (const auto index = index_of(situation_->hosted, id)) return index;
  if (situation_->sleepers == nullptr) return {};
  const auto place = situation_->sleepers->place_of(id);
  return place ? std::optional(admit(*place)) : std::nullopt;
}

void Stage::note_slots() {
  number_in_slot_.assign(situation_->contacts->slots(), none);
  for (std::uint32_t i = 0; i < size(); ++i) number_in_slot_[body(i).slot] = i;
}

void Stage::look_up_touching(std::uint32_t number) {
  if (number_in_slot_.empty()) note_slots();
  Touching answer{static_cast<std::uint32_t>(touching_.size()), 0, 0};
  answer.touched = situation_->contacts->find_touching(body(number).slot, slots_);
  for (const std::uint32_t slot : slots_) {
    std::uint32_t& known = number_in_slot_[slot];
    if (known == none) known = number_of(situation_->contacts->body_in(slot)).value_or(none);
    if (known != none) touching_.push_back(known);
  }
  answer.end = static_cast<std::uint32_t>(touching_.size());
  touching_of_[number] = answer;
}

std::size_t Stage::find_touching(std::uint32_t number, std::vector<std::uint32_t>& found) {
  if (touching_of_.size() <= number) touching_of_.resize(size());
  if (touching_of_[number].begin == none) look_up_touching(number);
  const Touching& known = touching_of_[number];
  found.assign(touching_.begin() + known.begin, touching_.begin() + known.end);
  return known.touched;
}

void Stage::fetch_touching(std::uint32_t number, FetchStep step) const {
  if (number < touching_of_.size() && touching_of_[number].begin != none) return;
  situation_->contacts->fetch_touching(body(number).slot, step);
}

std::span<const std::uint32_t> Stage::ascending() {
  if (ascending_.size() == bodies_.size()) return ascending_;
  ascending_.resize(bodies_.size());
  std::iota(ascending_.begin(), ascending_.end(), 0u);
  const auto by_id = [&](std::uint32_t a, std::uint32_t b) {
    return bodies_[a]->id < bodies_[b]->id;
  };
  const auto middle = static_cast<std::ptrdiff_t>(situation_->hosted.size());
  std::sort(ascending_.begin() + middle, ascending_.end(), by_id);
  merge_in(ascending_, middle, by_id);
  return ascending_;
}

}  // namespace aureole
