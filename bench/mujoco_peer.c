/* Functions of MuJoCo for the timed C program of robots.py: of its steps those alone that the result needs.
   Contacts, limits, passive forces and actuators take no part. Results are copied to `out` if there is one. */
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <string.h>

static mjModel *model;
static mjData *data;

int mujoco_load(const char *path)
{
    char error[1000];
    model = mj_loadXML(path, NULL, error, sizeof error);
    if (!model) {
        fprintf(stderr, "%s\n", error);
        return 1;
    }
    data = mj_makeData(model);
    return 0;
}

static void place(const double *q)
{
    memcpy(data->qpos, q, (size_t) model->nq * sizeof(double));
    mj_kinematics(model, data);
    mj_comPos(model, data);
}

void mujoco_forward(const double *q, const double *v, const double *tau, double *out)
{
    place(q);
    mj_makeM(model, data);
    mj_factorM(model, data);
    memcpy(data->qvel, v, (size_t) model->nv * sizeof(double));
    mj_comVel(model, data);
    mj_rne(model, data, 0, data->qfrc_bias);
    for (int i = 0; i < model->nv; i++) data->qfrc_smooth[i] = tau[i] - data->qfrc_bias[i];
    mj_solveM(model, data, data->qacc, data->qfrc_smooth, 1);
    if (out) memcpy(out, data->qacc, (size_t) model->nv * sizeof(double));
}

void mujoco_inverse(const double *q, const double *v, const double *a, double *out)
{
    place(q);
    memcpy(data->qvel, v, (size_t) model->nv * sizeof(double));
    memcpy(data->qacc, a, (size_t) model->nv * sizeof(double));
    mj_comVel(model, data);
    mj_rne(model, data, 1, data->qfrc_inverse);
    if (out) memcpy(out, data->qfrc_inverse, (size_t) model->nv * sizeof(double));
}

void mujoco_mass(const double *q, double *out)
{
    place(q);
    mj_makeM(model, data);
    if (out) mj_fullM(model, data, out);
}
