/* See io_hdf5.h. */
#include "io_hdf5.h"

#include <string.h>

/* At byte 0, 512, 1024, 2048 ...: files may begin with a block of the user's. */
bool io_is_hdf5(const io_cursor *bytes) {
    for (size_t at = 0; at + 8 <= bytes->size && at < 1u << 30; at = at ? 2 * at : 512)
        if (!memcmp(bytes->bytes + at, "\x89HDF\r\n\x1A\n", 8))
            return true;
    return false;
}

static bool holds(const uint8_t *bytes, size_t size, const char *word) {
    size_t length = strlen(word);
    for (size_t i = 0; i + length <= size; i++)
        if (bytes[i] == (uint8_t)word[0] && !memcmp(bytes + i, word, length))
            return true;
    return false;
}

/* HDF5 writes the names of the root's data sets as they are, near the begin. */
bool io_is_section_graph(const io_cursor *bytes) {
    size_t size = bytes->size < 65536 ? bytes->size : 65536;
    return io_is_hdf5(bytes) && holds(bytes->bytes, size, "points") &&
           holds(bytes->bytes, size, "structure") && holds(bytes->bytes, size, "connectivity");
}

#ifdef LINEAO_HAVE_HDF5
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- Talking --------------------------------------------------------------------------------- */

bool io_hdf5_send(int socket, const void *data, size_t size) {
    const char *at = data;
    while (size) {
        ssize_t sent = send(socket, at, size < (1u << 20) ? size : 1u << 20, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent <= 0)
            return false;
        at += sent;
        size -= (size_t)sent;
    }
    return true;
}

/* Waits for the child, letting the user cancel. */
bool io_hdf5_receive(io_reader *r, const io_hdf5_child *child, void *data, size_t size) {
    char *at = data;
    size_t total = size;
    while (size) {
        struct pollfd wait = {child->socket, POLLIN, 0};
        int ready = poll(&wait, 1, 100);
        if (!io_tick(r, total - size, total))
            return false;
        if (ready <= 0)
            continue;
        ssize_t got = recv(child->socket, at, size < (1u << 20) ? size : 1u << 20, 0);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return io_fail(r, "is damaged: libhdf5 crashes on it or does not come to an end; copy "
                              "the file again");
        at += got;
        size -= (size_t)got;
    }
    return true;
}

/* ---- Process --------------------------------------------------------------------------------- */

static hid_t open_image(const io_cursor *bytes) {
    hid_t list = H5Pcreate(H5P_FILE_ACCESS), file = -1;
    /* libhdf5 copies the bytes; its older interface lacks the const */
    if (list >= 0 && H5Pset_fapl_core(list, 1 << 16, 0) >= 0 &&
        H5Pset_file_image(list, (void *)(uintptr_t)bytes->bytes, bytes->size) >= 0)
        file = H5Fopen("memory", H5F_ACC_RDONLY, list);
    return file;
}

/* A crash ends the child alone, in silence; an endless loop ends too. */
static void become_child(size_t size) {
    static const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
    struct rlimit processor = {60 + (rlim_t)(size >> 20), 60 + (rlim_t)(size >> 20)};
    struct rlimit none = {0, 0};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++)
        signal(signals[i], SIG_DFL);
    setrlimit(RLIMIT_CPU, &processor);
    setrlimit(RLIMIT_CORE, &none);
    int silence = open("/dev/null", O_WRONLY);
    if (silence >= 0) {
        dup2(silence, STDOUT_FILENO);
        dup2(silence, STDERR_FILENO);
    }
}

bool io_hdf5_start(io_reader *r, const io_cursor *bytes, void (*serve)(int socket, hid_t file),
                   io_hdf5_child *out) {
    int sockets[2];
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, sockets))
        return io_fail(r, "cannot be read: %s", strerror(errno));
    pid_t pid = fork();
    if (pid == 0) {
        close(sockets[0]);
        become_child(bytes->size);
        H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
        serve(sockets[1], open_image(bytes));
        _exit(0);
    }
    close(sockets[1]);
    if (pid < 0) {
        close(sockets[0]);
        return io_fail(r, "cannot be read: %s", strerror(errno));
    }
    out->socket = sockets[0];
    out->pid = (long)pid;
    return true;
}

void io_hdf5_stop(io_hdf5_child *child) {
    close(child->socket);
    kill((pid_t)child->pid, SIGKILL);
    while (waitpid((pid_t)child->pid, NULL, 0) < 0 && errno == EINTR) {
    }
}
#endif
