#include "pipeline/learn/training/train_members.h"

#include <cmath>
#include <map>

#include "base/error.h"
#include "base/hash.h"
#include "base/progress.h"
#include "base/random.h"
#include "learning/model/model.h"
#include "learning/rbm/train.h"
#include "learning/sampler/stand_in.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/learn/training/contract_model.h"
#include "pipeline/learn/training/kept_work.h"
#include "pipeline/learn/training/teacher.h"
#include "pipeline/learn/training/training_data.h"

namespace gonogo::learn {
namespace {

/// Times Exp(1) for each group, then to mean 1 again.
void reweigh(learning::TrainingTable& table, std::uint64_t seed, int member) {
  std::map<std::uint64_t, double> factor;
  double sum = 0;
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    const auto [place, is_new] = factor.try_emplace(table.group[n], 0.0);
    if (is_new) place->second = -std::log1p(-random_unit(seed, std::uint64_t(member), table.group[n]));
    table.weight[n] *= place->second;
    sum += table.weight[n];
  }
  for (double& weight : table.weight) weight *= double(table.row_count()) / sum;
}

}  // namespace

std::vector<std::filesystem::path> train_members(const TrainRequest& request, int count) {
  const learning::Model base = read_contract_model(request.model);
  if (base.provenance.at("data_hash").string() != file_hash(request.dataset))
    throw InputError(request.model.string() + ": was trained on other trials than " + request.dataset.string() +
                     "; train it anew with gonogo train");
  LearningSettings settings = trainable_settings(request.learning);
  TrainingData data = make_training_data(campaign::read_dataset(request.dataset).records, request.design);
  temper_weights(data, settings.importance);
  if (request.hold_out > 0) hold_out(data, request.hold_out, request.seed);
  settings = settings_for_trials(std::move(settings), data.table.row_count());
  learning::TrainingSettings training = training_settings(settings, data.table.row_count(), request.seed);
  training.epochs = std::size_t(base.provenance.at("epochs").unsigned_integer());
  const bool outside = settings.sampler == "command" || settings.sampler == "emulator";  // members take the stand-in
  const auto sampler = learning::make_sampler(outside ? settings.stand_in : settings.sampler);
  const double taught = settings.teacher.value_or(teacher_weight(data.table.row_count()));
  std::vector<std::filesystem::path> files;
  const OtherTrials others = read_other_trials(request.dataset, request.others);
  const KeptWork kept(request.model, work_key(request, settings));
  Progress progress("train", "members", std::size_t(count));
  std::size_t reused = 0;
  for (int member = 1; member <= count; ++member) {
    files.push_back(request.model.parent_path() /
                    (request.model.stem().string() + ".member" + std::to_string(member) + ".h5"));
    if (kept.has_member(files.back())) {
      progress.update(std::size_t(member), "", ++reused);
      continue;
    }
    learning::TrainingTable table = data.table;
    reweigh(table, request.seed, member);
    training.seed = random_bits(request.seed, 1, std::uint64_t(member));
    learning::Model model = base;
    const auto lesson = teach_all(table, others, data.lower, data.upper, taught, training.seed);
    model.weights = learning::train_rbm(base.layout, table, training, *sampler, {}, nullptr, lesson.get()).weights;
    model.provenance["member"] = member;
    learning::write_model(files.back(), model);
    kept.keep_member(files.back());
    progress.update(std::size_t(member), "", reused);
  }
  kept.remove();
  return files;
}

}  // namespace gonogo::learn
