/*
 * SPDX-License-Identifier: 0BSD
 *
 * The types of FMI 2.0, as its published interface has them, and the names of its functions.
 */

#ifndef TISSERAND_FMI2_H
#define TISSERAND_FMI2_H

#include <stddef.h>

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;

enum { fmi2False = 0, fmi2True = 1 };

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

/* What the importer provides. */
typedef struct {
    void (*logger)(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                   fmi2String message, ...);
    void *(*allocateMemory)(size_t count, size_t size);
    void (*freeMemory)(void *memory);
    void (*stepFinished)(fmi2ComponentEnvironment environment, fmi2Status status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

typedef struct {
    fmi2Boolean newDiscreteStatesNeeded;
    fmi2Boolean terminateSimulation;
    fmi2Boolean nominalsOfContinuousStatesChanged;
    fmi2Boolean valuesOfContinuousStatesChanged;
    fmi2Boolean nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

#if defined(_WIN32)
#  define FMI2_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#  define FMI2_EXPORT __attribute__((visibility("default")))
#else
#  define FMI2_EXPORT
#endif

/* The name of a function: FMI2_FUNCTION_PREFIX is for importers that link the sources of a unit to a program. */
#define FMI2_JOIN_NAMES(prefix, name) prefix##name
#define FMI2_JOIN(prefix, name) FMI2_JOIN_NAMES(prefix, name)
#if defined(FMI2_OVERRIDE_FUNCTION_PREFIX)
#  define FMI2(name) FMI2_JOIN(FMI2_OVERRIDE_FUNCTION_PREFIX, fmi2##name)
#elif defined(FMI2_FUNCTION_PREFIX)
#  define FMI2(name) FMI2_JOIN(FMI2_FUNCTION_PREFIX, fmi2##name)
#else
#  define FMI2(name) fmi2##name
#endif

#endif
