/*
 * SPDX-License-Identifier: 0BSD
 *
 * What an importer of FMI 3.0 holds: an instance and its callback.
 */

#ifndef TISSERAND_FMU_COMPONENT3_H
#define TISSERAND_FMU_COMPONENT3_H

#include "fmi3.h"
#include "instance.h"

typedef struct {
    fmu_instance *fmu;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} component;

static inline fmu_instance *of(fmi3Instance c)
{
    return ((component *) c)->fmu;
}

static inline fmi3Status refuse(fmi3Instance c, const char *message)
{
    return (fmi3Status) fmu_fail(of(c), FMU_ERROR, message);
}

#endif
