/* Functions of Pinocchio for the timed C program of robots.py: one model, read from a file of numbers.
   Results are left where Pinocchio puts them, and copied to `out` if there is one. */
#include "pinocchio/multibody.hpp"
#include "pinocchio/algorithm/aba.hpp"
#include "pinocchio/algorithm/crba.hpp"
#include "pinocchio/algorithm/rnea.hpp"

#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

using namespace pinocchio;

static std::unique_ptr<Model> model;
static std::unique_ptr<Data> data;

typedef Eigen::Map<const Eigen::VectorXd> View;

static JointIndex add(JointIndex parent, int kind, const Eigen::Vector3d &axis, const SE3 &at, const std::string &name)
{
    switch (kind) {
    case 0: return model->addJoint(parent, JointModelFreeFlyer(), at, name);
    case 1: return model->addJoint(parent, JointModelRX(), at, name);
    case 2: return model->addJoint(parent, JointModelRY(), at, name);
    case 3: return model->addJoint(parent, JointModelRZ(), at, name);
    case 4: return model->addJoint(parent, JointModelRevoluteUnaligned(axis), at, name);
    case 5: return model->addJoint(parent, JointModelPX(), at, name);
    case 6: return model->addJoint(parent, JointModelPY(), at, name);
    case 7: return model->addJoint(parent, JointModelPZ(), at, name);
    default: return model->addJoint(parent, JointModelPrismaticUnaligned(axis), at, name);
    }
}

static Eigen::Matrix3d rows(const double *x)
{
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(x);
}

/* Joint by joint: parent, kind, axis, position and rotation; then mass, centre and inertia of its body. */
extern "C" int pinocchio_load(const char *path)
{
    enum { SIZE = 30 };
    std::FILE *file = std::fopen(path, "rb");
    if (!file) return 1;
    model = std::make_unique<Model>();
    model->gravity.linear() << 0, 0, -9.81;
    double x[SIZE];
    while (std::fread(x, sizeof(double), SIZE, file) == SIZE) {
        const SE3 at(rows(x + 8), Eigen::Vector3d(x[5], x[6], x[7]));
        const JointIndex joint = add((JointIndex) x[0], (int) x[1], Eigen::Vector3d(x[2], x[3], x[4]), at,
                                     "joint" + std::to_string(model->njoints));
        const Inertia body(x[17], Eigen::Vector3d(x[18], x[19], x[20]), rows(x + 21));
        model->appendBodyToJoint(joint, body, SE3::Identity());
    }
    std::fclose(file);
    data = std::make_unique<Data>(*model);
    return 0;
}

static void forward(const double *q, const double *v, const double *tau, double *out, Convention convention)
{
    const int n = model->nv;
    const auto &a = aba(*model, *data, View(q, model->nq), View(v, n), View(tau, n), convention);
    if (out) std::memcpy(out, a.data(), (size_t) n * sizeof(double));
}

static void mass(const double *q, double *out, Convention convention)
{
    const int n = model->nv;
    const auto &M = crba(*model, *data, View(q, model->nq), convention);
    if (out) for (int j = 0; j < n; j++) for (int i = 0; i < n; i++) out[i * n + j] = i <= j ? M(i, j) : M(j, i);
}

extern "C" {
void pinocchio_aba_local(const double *q, const double *v, const double *tau, double *out)
{
    forward(q, v, tau, out, Convention::LOCAL);
}
void pinocchio_aba_world(const double *q, const double *v, const double *tau, double *out)
{
    forward(q, v, tau, out, Convention::WORLD);
}
void pinocchio_crba_local(const double *q, double *out) { mass(q, out, Convention::LOCAL); }
void pinocchio_crba_world(const double *q, double *out) { mass(q, out, Convention::WORLD); }
void pinocchio_rnea(const double *q, const double *v, const double *a, double *out)
{
    const int n = model->nv;
    const auto &tau = rnea(*model, *data, View(q, model->nq), View(v, n), View(a, n));
    if (out) std::memcpy(out, tau.data(), (size_t) n * sizeof(double));
}
}
