// Studies, designs, trials, datasets and campaigns of many trials.
// Package component `sim`; link gonogo::trial, gonogo::dataset, gonogo::study_campaign.
#pragma once
#include "base/error.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/dataset/summary.h"
#include "pipeline/campaign/design/design.h"
#include "pipeline/campaign/engine/study_campaign.h"
#include "pipeline/campaign/setup/read_setup.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/campaign/trial/trial.h"
