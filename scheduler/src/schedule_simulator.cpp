#include <sweepgrid/scheduler/schedule_simulator.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <deque>
#include <numeric>
#include <queue>
#include <stdexcept>
#include <utility>

#include "task_order.hpp"

namespace sweepgrid {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// What a worker can take: the serial part of a stage, or places [begin, end) of its tasks.
struct Offer {
  std::uint32_t stage = 0;
  bool serial = false;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

struct Worker {
  std::deque<Offer> offers;
  std::uint64_t look = 0;  // number of the event that will make it look, or 0
  double idle_since = -kNever;
  // What it runs, if anything.
  bool running = false;
  ScheduledTask task;
  double memory_share = 0;
  double left = 0;  // seconds at full speed
};

struct SimulatedStage {
  std::vector<std::uint32_t> before;  // stages that wait for this one
  std::uint32_t waits_for = 0;
  std::size_t tasks_left = 0;
  std::uint32_t home = 0;            // worker that did the serial part
  std::vector<std::uint32_t> order;  // task by place
};

/// A worker looks for work, or a stage has become ready.
struct Event {
  double time = 0;
  std::uint64_t number = 0;
  bool stage_ready = false;
  std::uint32_t subject = 0;

  friend bool operator>(const Event& a, const Event& b) {
    return a.time != b.time ? a.time > b.time : a.number > b.number;
  }
};

class Simulation {
 public:
  Simulation(const WorkGraph& graph, int workers, SchedulePolicy policy, const ScheduleCosts& costs);
  Schedule run();

 private:
  void order_tasks(SimulatedStage& stage, const std::vector<WorkTask>& tasks) const;
  void handle(const Event& event);
  void stage_ready(std::uint32_t stage);
  void open_stage(std::uint32_t worker, std::uint32_t stage);
  void end_stage(std::uint32_t stage);
  void task_ended(std::uint32_t worker);
  void look(std::uint32_t worker);
  bool take(std::uint32_t worker);
  bool take_longest(std::uint32_t worker);
  bool steal(std::uint32_t thief);
  [[nodiscard]] bool work_for(std::uint32_t worker) const;
  void begin(std::uint32_t worker, Offer offer);
  void begin_task(std::uint32_t worker, std::uint32_t stage, std::uint32_t task);
  void call_idle_workers(std::uint32_t except);
  std::uint64_t post(double delay, bool stage_ready, std::uint32_t subject);
  void update_slowdown();
  [[nodiscard]] double rate(const Worker& worker) const { return 1 / (1 + worker.memory_share * (slowdown_ - 1)); }
  void advance_to(double time);

  const WorkGraph& graph_;
  SchedulePolicy policy_;
  ScheduleCosts costs_;
  double barrier_ = 0;
  std::vector<Worker> workers_;
  std::vector<SimulatedStage> stages_;
  std::deque<std::pair<std::uint32_t, std::uint32_t>> longest_;  // stage and task, for kLongestFirst
  std::size_t offers_ = 0;                                       // in the queues of all workers
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  std::uint64_t last_number_ = 0;
  std::size_t stages_left_;
  double now_ = 0;
  double slowdown_ = 1;  // of what is bound by memory
  std::uint64_t random_ = 0x9e3779b97f4a7c15;
  Schedule schedule_;
};

Simulation::Simulation(const WorkGraph& graph, int workers, SchedulePolicy policy, const ScheduleCosts& costs)
    : graph_(graph), policy_(policy), workers_(static_cast<std::size_t>(workers)), stages_left_(graph.size()) {
  costs_.memory_roof = costs.memory_roof;
  if (workers > 1) {
    costs_ = costs;
    barrier_ = costs.barrier * static_cast<double>(std::bit_width(static_cast<unsigned>(workers - 1)));
  }
  stages_.resize(graph.size());
  for (std::uint32_t id = 0; id < graph.size(); ++id) {
    SimulatedStage& stage = stages_[id];
    stage.waits_for = static_cast<std::uint32_t>(graph[id].after.size());
    stage.tasks_left = graph[id].tasks.size();
    for (const std::uint32_t earlier : graph[id].after) stages_[earlier].before.push_back(id);
    order_tasks(stage, graph[id].tasks);
  }
  schedule_.stages.resize(graph.size());
  schedule_.busy.resize(workers_.size());
}

void Simulation::order_tasks(SimulatedStage& stage, const std::vector<WorkTask>& tasks) const {
  stage.order.resize(tasks.size());
  std::iota(stage.order.begin(), stage.order.end(), std::uint32_t{0});
  if (policy_ == SchedulePolicy::kLongestFirst) {
    std::stable_sort(stage.order.begin(), stage.order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return tasks[a].seconds > tasks[b].seconds; });
  }
  // Loops outside of stage graphs have no estimates, and run in the order of their indices.
  const auto sized = [](const WorkTask& task) { return task.size > 0; };
  if (policy_ != SchedulePolicy::kWorkStealing || std::none_of(tasks.begin(), tasks.end(), sized)) return;
  std::vector<std::uint64_t> sizes;
  sizes.reserve(tasks.size());
  for (const WorkTask& task : tasks) sizes.push_back(task.size);
  TaskOrder order;
  order.assign_for_stealing(sizes);
  for (std::size_t place = 0; place < tasks.size(); ++place) stage.order[place] = order.task(place);
}

Schedule Simulation::run() {
  for (std::uint32_t id = 0; id < stages_.size(); ++id) {
    if (stages_[id].waits_for == 0) stage_ready(id);
  }
  while (stages_left_ > 0) {
    std::uint32_t first = 0;
    double end = kNever;
    for (std::uint32_t w = 0; w < workers_.size(); ++w) {
      if (!workers_[w].running) continue;
      const double own = now_ + workers_[w].left / rate(workers_[w]);
      if (own < end) end = own, first = w;
    }
    if (!events_.empty() && events_.top().time < end) {
      const Event event = events_.top();
      events_.pop();
      advance_to(event.time);
      handle(event);
    } else {
      advance_to(end);
      task_ended(first);
    }
  }
  schedule_.makespan = now_;
  std::stable_sort(schedule_.tasks.begin(), schedule_.tasks.end(),
                   [](const ScheduledTask& a, const ScheduledTask& b) { return a.start < b.start; });
  return std::move(schedule_);
}

void Simulation::handle(const Event& event) {
  if (event.stage_ready) return stage_ready(event.subject);
  if (workers_[event.subject].look == event.number) look(event.subject);
}

// ---- stages

// The worker that did the serial part of a stage waits for its end and goes on with the next.
void Simulation::stage_ready(std::uint32_t stage) {
  std::uint32_t home = 0;
  double latest = -1;
  for (const std::uint32_t earlier : graph_[stage].after) {
    if (schedule_.stages[earlier].end > latest) latest = schedule_.stages[earlier].end, home = stages_[earlier].home;
  }
  Worker& worker = workers_[home];
  worker.offers.push_back({stage, true, 0, 0});
  ++offers_;
  if (!worker.running) look(home);
  call_idle_workers(home);
}

void Simulation::open_stage(std::uint32_t worker, std::uint32_t stage) {
  const auto count = static_cast<std::uint32_t>(stages_[stage].order.size());
  if (count == 0) return end_stage(stage);
  switch (policy_) {
    case SchedulePolicy::kWorkStealing:
      workers_[worker].offers.push_back({stage, false, 0, count});
      ++offers_;
      break;
    case SchedulePolicy::kStaticRanges: {
      const std::size_t shares = workers_.size();
      for (std::size_t w = 0; w < shares; ++w) {
        const auto begin = static_cast<std::uint32_t>(w * count / shares);
        const auto end = static_cast<std::uint32_t>((w + 1) * count / shares);
        for (std::uint32_t i = begin; i < end; ++i) workers_[w].offers.push_back({stage, false, i, i + 1});
        offers_ += end - begin;
      }
      break;
    }
    case SchedulePolicy::kLongestFirst: {
      std::vector<std::pair<std::uint32_t, std::uint32_t>> added;
      added.reserve(count);
      for (const std::uint32_t task : stages_[stage].order) added.emplace_back(stage, task);
      const auto longer = [&](const auto& a, const auto& b) {
        return graph_[a.first].tasks[a.second].seconds > graph_[b.first].tasks[b.second].seconds;
      };
      const auto middle = static_cast<std::ptrdiff_t>(longest_.size());
      longest_.insert(longest_.end(), added.begin(), added.end());
      std::inplace_merge(longest_.begin(), longest_.begin() + middle, longest_.end(), longer);
      break;
    }
  }
  call_idle_workers(worker);
}

void Simulation::end_stage(std::uint32_t stage) {
  schedule_.stages[stage].end = now_;
  --stages_left_;
  for (const std::uint32_t next : stages_[stage].before) {
    if (--stages_[next].waits_for == 0) post(graph_[stage].tasks.empty() ? 0 : barrier_, true, next);
  }
}

// ---- workers

void Simulation::task_ended(std::uint32_t w) {
  Worker& worker = workers_[w];
  worker.running = false;
  worker.idle_since = now_;
  worker.task.duration = now_ - worker.task.start;
  schedule_.busy[w] += worker.task.duration;
  schedule_.tasks.push_back(worker.task);
  update_slowdown();
  const std::uint32_t stage = worker.task.stage;
  if (worker.task.task == ScheduledTask::kSerialPart) {
    open_stage(w, stage);
  } else if (--stages_[stage].tasks_left == 0) {
    end_stage(stage);
  }
  if (worker.offers.empty() && longest_.empty() && work_for(w)) {
    worker.look = post(costs_.steal, false, w);
  } else {
    look(w);
  }
}

void Simulation::look(std::uint32_t w) {
  workers_[w].look = 0;
  if (!take(w)) workers_[w].idle_since = now_;
}

bool Simulation::work_for(std::uint32_t w) const {
  if (!workers_[w].offers.empty() || !longest_.empty()) return true;
  return policy_ != SchedulePolicy::kStaticRanges && offers_ > 0;
}

bool Simulation::take(std::uint32_t w) {
  std::deque<Offer>& own = workers_[w].offers;
  if (!own.empty()) {
    const bool oldest = policy_ == SchedulePolicy::kStaticRanges;
    const Offer offer = oldest ? own.front() : own.back();
    oldest ? own.pop_front() : own.pop_back();
    --offers_;
    begin(w, offer);
    return true;
  }
  return take_longest(w) || (policy_ != SchedulePolicy::kStaticRanges && steal(w));
}

bool Simulation::take_longest(std::uint32_t w) {
  if (longest_.empty()) return false;
  const auto [stage, task] = longest_.front();
  longest_.pop_front();
  begin_task(w, stage, task);
  return true;
}

bool Simulation::steal(std::uint32_t thief) {
  std::vector<std::uint32_t> victims;
  for (std::uint32_t w = 0; w < workers_.size(); ++w) {
    if (!workers_[w].offers.empty()) victims.push_back(w);
  }
  if (victims.empty()) return false;
  random_ ^= random_ << 13, random_ ^= random_ >> 7, random_ ^= random_ << 17;  // Marsaglia's xorshift
  std::deque<Offer>& offers = workers_[victims[random_ % victims.size()]].offers;
  const Offer offer = offers.front();
  offers.pop_front();
  --offers_;
  ++schedule_.steals;
  begin(thief, offer);
  return true;
}

// Halves what it took, and offers the far halves, before it begins.
void Simulation::begin(std::uint32_t w, Offer offer) {
  if (offer.serial) {
    schedule_.stages[offer.stage].start = now_;
    stages_[offer.stage].home = w;
    return begin_task(w, offer.stage, ScheduledTask::kSerialPart);
  }
  const bool alone = offer.end - offer.begin == 1;
  while (offer.end - offer.begin > 1) {
    const std::uint32_t middle = offer.begin + (offer.end - offer.begin) / 2;
    workers_[w].offers.push_back({offer.stage, false, middle, offer.end});
    ++offers_;
    offer.end = middle;
  }
  begin_task(w, offer.stage, stages_[offer.stage].order[offer.begin]);
  if (!alone) call_idle_workers(w);
}

void Simulation::begin_task(std::uint32_t w, std::uint32_t stage, std::uint32_t task) {
  Worker& worker = workers_[w];
  worker.running = true;
  worker.task = {stage, task, w, now_, 0};
  worker.memory_share = 0;
  if (task == ScheduledTask::kSerialPart) {
    worker.left = graph_[stage].serial;
  } else {
    const WorkTask& work = graph_[stage].tasks[task];
    worker.left = costs_.spawn + work.seconds;
    if (worker.left > 0) worker.memory_share = work.memory_share * work.seconds / worker.left;
  }
  update_slowdown();
}

void Simulation::call_idle_workers(std::uint32_t except) {
  unsigned woken = 0;
  for (std::uint32_t w = 0; w < workers_.size(); ++w) {
    Worker& worker = workers_[w];
    if (w == except || worker.running || worker.look != 0 || !work_for(w)) continue;
    double delay = costs_.steal;
    if (now_ - worker.idle_since > costs_.spin) delay += costs_.wake * static_cast<double>(std::bit_width(++woken));
    worker.look = post(delay, false, w);
  }
}

// ---- time

std::uint64_t Simulation::post(double delay, bool stage_ready, std::uint32_t subject) {
  events_.push({now_ + delay, ++last_number_, stage_ready, subject});
  return last_number_;
}

void Simulation::update_slowdown() {
  double asked = 0;
  for (const Worker& worker : workers_) asked += worker.running ? worker.memory_share : 0;
  slowdown_ = std::max(1.0, asked / costs_.memory_roof);
}

void Simulation::advance_to(double time) {
  for (Worker& worker : workers_) {
    if (worker.running) worker.left = std::max(0.0, worker.left - (time - now_) * rate(worker));
  }
  now_ = time;
}

void require_valid(int workers, const ScheduleCosts& costs) {
  if (workers < 1) throw std::invalid_argument("a schedule needs a worker, not " + std::to_string(workers));
  for (const double cost : {costs.spawn, costs.steal, costs.wake, costs.spin, costs.barrier}) {
    if (!(cost >= 0)) throw std::invalid_argument("costs of a schedule must not be negative");
  }
  if (!(costs.memory_roof >= 1)) throw std::invalid_argument("the memory roof must not be below 1");
}

}  // namespace

Schedule simulate(const WorkGraph& graph, int workers, SchedulePolicy policy, const ScheduleCosts& costs) {
  require_valid(workers, costs);
  static_cast<void>(work_and_span(graph));  // refuses what is no work graph
  return Simulation(graph, workers, policy, costs).run();
}

}  // namespace sweepgrid
