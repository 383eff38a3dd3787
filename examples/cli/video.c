#include "video.h"

#include "image.h"
#include "image_file.h"
#include "report.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { MOST_ARGUMENTS = 16 };

/* Even sizes, because the usual colour format has half as many colours as pixels. */
#define EVEN "pad=ceil(iw/2)*2:ceil(ih/2)*2"
#define PALETTE "split[a][b];[a]palettegen[p];[b][p]paletteuse"

static const struct {
    const char *ending, *format;
    const char *arguments[MOST_ARGUMENTS];
} formats[] = {
    {".mp4",
     "mp4",
     {"-c:v", "libx264", "-pix_fmt", "yuv420p", "-vf", EVEN, "-crf", "18", "-movflags",
      "+faststart"}},
    {".webm",
     "webm",
     {"-c:v", "libvpx-vp9", "-pix_fmt", "yuv420p", "-vf", EVEN, "-crf", "24", "-b:v", "0"}},
    {".gif", "gif", {"-vf", PALETTE, "-loop", "0"}},
};
enum { FORMATS = sizeof formats / sizeof *formats };

static int find_format(const char *path) {
    size_t length = path ? strlen(path) : 0;
    for (int i = 0; i < FORMATS; i++) {
        size_t ending = strlen(formats[i].ending);
        if (length > ending && strcmp(path + length - ending, formats[i].ending) == 0)
            return i;
    }
    return -1;
}

bool cli_is_video(const char *path) {
    return find_format(path) >= 0;
}

/* ffmpeg with the pipe as its input and the unnamed file for what it says. It does not get our
 * Ctrl-C: we end it, and remove what it wrote. */
static int spawn(cli_video *video, char *const *arguments, int input) {
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    sigset_t none, usual;
    int error = posix_spawn_file_actions_init(&files);
    if (error)
        return error;
    error = posix_spawnattr_init(&attributes);
    if (error) {
        posix_spawn_file_actions_destroy(&files);
        return error;
    }
    sigemptyset(&none);
    sigemptyset(&usual);
    sigaddset(&usual, SIGPIPE);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK |
                                              POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &usual);
    error = posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
    if (!error)
        error = posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    if (!error)
        error = posix_spawn_file_actions_adddup2(&files, fileno(video->said), STDERR_FILENO);
    if (!error)
        error = posix_spawnp(&video->process, "ffmpeg", &files, &attributes, arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    return error;
}

static int start(cli_video *video, uint32_t width, uint32_t height, uint32_t fps) {
    char size[32], rate[16];
    const char *fixed[] = {"ffmpeg", "-nostdin", "-hide_banner", "-v",     "error", "-y",
                           "-f",     "rawvideo", "-pix_fmt",     "rgb24",  "-s",    size,
                           "-r",     rate,       "-i",           "pipe:0", "-an"};
    enum { FIXED = sizeof fixed / sizeof *fixed };
    char *arguments[FIXED + MOST_ARGUMENTS + 4];
    int ends[2], format = find_format(video->path), count = 0;
    snprintf(size, sizeof size, "%ux%u", (unsigned)width, (unsigned)height);
    snprintf(rate, sizeof rate, "%u", (unsigned)fps);
    for (int i = 0; i < FIXED; i++)
        memcpy(&arguments[count++], &fixed[i], sizeof *arguments);
    for (int i = 0; i < MOST_ARGUMENTS && formats[format].arguments[i]; i++)
        memcpy(&arguments[count++], &formats[format].arguments[i], sizeof *arguments);
    const char *last[] = {"-f", formats[format].format, video->temp, NULL};
    memcpy(&arguments[count], last, sizeof last);
    if (pipe(ends) != 0)
        return errno;
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    fcntl(ends[1], F_SETFD, FD_CLOEXEC);
    int error = spawn(video, arguments, ends[0]);
    close(ends[0]);
    if (error)
        close(ends[1]);
    else
        video->pipe = ends[1];
    return error;
}

bool cli_video_open(cli_video *video, const char *path, uint32_t width, uint32_t height,
                    uint32_t fps) {
    char error[IMAGE_ERROR_SIZE];
    memset(video, 0, sizeof *video);
    video->path = path;
    video->frame_size = 3 * (size_t)width * height;
    video->temp = image_temp_create(path, error);
    if (!video->temp)
        return cli_fail("%s", error);
    video->said = tmpfile();
    signal(SIGPIPE, SIG_IGN); /* an end of ffmpeg is a failed write */
    int reason = video->said ? start(video, width, height, fps) : errno;
    if (!reason)
        return true;
    if (reason == ENOENT)
        image_fail(error, path, "ffmpeg is not in PATH; install it, or write pictures: -o x.png");
    else
        image_fail(error, path, strerror(reason));
    image_temp_finish(video->temp, path, false, error);
    if (video->said)
        fclose(video->said);
    return cli_fail("%s", error);
}

bool cli_video_add(cli_video *video, const uint8_t *pixels) {
    video->broken = true;
    for (size_t done = 0; done < video->frame_size;) {
        ssize_t n = write(video->pipe, pixels + done, video->frame_size - done);
        if (n < 0 && errno != EINTR)
            return false; /* ffmpeg has ended; cli_video_close tells why */
        done += n > 0 ? (size_t)n : 0;
    }
    video->broken = false;
    return true;
}

/* The last line that ffmpeg said. */
static void last_words(cli_video *video, char *text, int room) {
    char line[256];
    rewind(video->said);
    snprintf(text, (size_t)room, "ffmpeg failed");
    while (fgets(line, sizeof line, video->said)) {
        if (line[strspn(line, " \n")] != '\0')
            snprintf(text, (size_t)room, "ffmpeg: %.*s", (int)strcspn(line, "\n"), line);
    }
}

bool cli_video_close(cli_video *video, bool ok) {
    char error[IMAGE_ERROR_SIZE] = "", words[128];
    int status = 0;
    ok = ok || video->broken; /* then the reason is ffmpeg's */
    if (!ok)
        kill(video->process, SIGKILL);
    close(video->pipe);
    while (waitpid(video->process, &status, 0) < 0 && errno == EINTR) {
    }
    bool ended = WIFEXITED(status) && WEXITSTATUS(status) == 0 && !video->broken;
    if (ok && !ended) {
        last_words(video, words, sizeof words);
        image_fail(error, video->path, words);
    }
    fclose(video->said);
    bool written = image_temp_finish(video->temp, video->path, ok && ended, error);
    return written || (ok && cli_fail("%s", error));
}
