// Dear ImGui behind ui.h.
#include "ui.h"

extern "C" {
#include "host_vk.h"
#include "report.h"
}

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <map>
#include <string>
#include <string.h>
#include <vector>

namespace {

// The one interface; Dear ImGui has one context of its own besides.
struct interface {
    bool gl = false, vk = false;
    VkDevice device = VK_NULL_HANDLE;
    VkDescriptorPool pool = VK_NULL_HANDLE;
    ui_desc desc = {1, nullptr, nullptr};
    std::map<std::string, ImVec4> places;
    const char *name = nullptr; // of the widgets to come
};
interface *ui = nullptr;

const float background[3] = {0.16f, 0.17f, 0.18f};
const char *const font_file = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

void place(const char *label, ImVec2 a, ImVec2 b) {
    if (!ui->desc.placed)
        return;
    ImVec4 &old = ui->places[label];
    if (old.x == a.x && old.y == a.y && old.z == b.x && old.w == b.y)
        return;
    old = ImVec4(a.x, a.y, b.x, b.y);
    window_rect rect = {(int)a.x, (int)a.y, (int)(b.x - a.x), (int)(b.y - a.y)};
    ui->desc.placed(ui->desc.user, label, rect);
}

// Tells a test where the widget before is, if it can be seen.
bool placed(const char *label, bool result) {
    std::string name = ui->name ? std::string(ui->name) + " " + label : label;
    if (ImGui::IsItemVisible())
        place(name.c_str(), ImGui::GetItemRectMin(), ImGui::GetItemRectMax());
    return result;
}

void look(float scale) {
    ImGui::StyleColorsDark();
    ImGuiStyle &style = ImGui::GetStyle();
    style.WindowRounding = 0;
    style.FrameRounding = 3;
    style.GrabRounding = 3;
    style.WindowBorderSize = 0;
    style.FramePadding = ImVec2(5, 3);
    style.ItemSpacing = ImVec2(7, 5);
    style.ScrollbarSize = 12;
    style.Colors[ImGuiCol_WindowBg] = ImVec4(background[0], background[1], background[2], 1);
    style.Colors[ImGuiCol_PopupBg] = ImVec4(0.12f, 0.13f, 0.14f, 0.98f);
    style.Colors[ImGuiCol_TextDisabled] = ImVec4(0.62f, 0.64f, 0.66f, 1);
    style.ScaleAllSizes(scale);
    ImFontAtlas *fonts = ImGui::GetIO().Fonts;
    FILE *file = fopen(font_file, "rb");
    if (file)
        fclose(file);
    ImFontConfig config;
    config.SizePixels = 13 * scale;
    if (!file || !fonts->AddFontFromFileTTF(font_file, 14 * scale))
        fonts->AddFontDefault(&config);
}

bool open_vk(window *w) {
    ui_vulkan from;
    window_vk_interface(w, &from);
    ui->device = host_vk_device(from.host);
    VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1};
    VkDescriptorPoolCreateInfo pool = {};
    pool.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    pool.maxSets = 1;
    pool.poolSizeCount = 1;
    pool.pPoolSizes = &size;
    if (vkCreateDescriptorPool(ui->device, &pool, nullptr, &ui->pool) != VK_SUCCESS)
        return cli_fail("vk: no memory for the user interface");
    ImGui_ImplVulkan_InitInfo info = {};
    info.Instance = host_vk_instance(from.host);
    info.PhysicalDevice = host_vk_physical(from.host);
    info.Device = ui->device;
    info.QueueFamily = host_vk_family(from.host);
    info.Queue = host_vk_queue(from.host);
    info.DescriptorPool = ui->pool;
    info.MinImageCount = 2;
    info.ImageCount = from.images < 2 ? 2 : from.images;
    ui->vk = ImGui_ImplVulkan_Init(&info, (VkRenderPass)from.pass);
    VkCommandBuffer commands = ui->vk ? host_vk_begin(from.host) : VK_NULL_HANDLE;
    bool ok = commands && ImGui_ImplVulkan_CreateFontsTexture(commands) &&
              host_vk_submit_and_wait(from.host, commands);
    ImGui_ImplVulkan_DestroyFontUploadObjects();
    return ok || cli_fail("vk: the user interface could not be made");
}

ImU32 color_of(uint32_t color) {
    return color;
}

ImDrawList *list_of(bool over) {
    return over ? ImGui::GetBackgroundDrawList() : ImGui::GetWindowDrawList();
}

} // namespace

extern "C" {

// ---- life ----

bool ui_open(window *w, const ui_desc *desc) {
    ui = new interface;
    ui->desc = *desc;
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui::GetIO().ConfigWindowsMoveFromTitleBarOnly = true;
    look(desc->scale);
    if (w->vk)
        return ImGui_ImplGlfw_InitForVulkan(w->glfw, true) && open_vk(w);
    ui->gl = ImGui_ImplGlfw_InitForOpenGL(w->glfw, true) && ImGui_ImplOpenGL3_Init("#version 330");
    return ui->gl || cli_fail("gl: the user interface could not be made");
}

void ui_close(void) {
    if (!ui)
        return;
    if (ui->vk)
        ImGui_ImplVulkan_Shutdown();
    if (ui->pool)
        vkDestroyDescriptorPool(ui->device, ui->pool, nullptr);
    if (ui->gl)
        ImGui_ImplOpenGL3_Shutdown();
    if (ImGui::GetIO().BackendPlatformUserData)
        ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    delete ui;
    ui = nullptr;
}

float ui_scale(void) {
    return ui->desc.scale;
}

const float *ui_background(void) {
    return background;
}

void ui_begin(void) {
    if (ui->vk)
        ImGui_ImplVulkan_NewFrame();
    else
        ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
}

void ui_end(void) {
    ImGui::Render();
}

void ui_draw_gl(void) {
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void ui_draw_vk(void *commands) {
    ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), (VkCommandBuffer)commands);
}

bool ui_has_pointer(void) {
    return ImGui::GetIO().WantCaptureMouse;
}

bool ui_has_keyboard(void) {
    return ImGui::GetIO().WantTextInput;
}

bool ui_active(void) {
    return ImGui::IsAnyItemActive();
}

// ---- panels ----

void ui_panel(const char *name, window_rect at) {
    ImGui::SetNextWindowPos(ImVec2((float)at.x, (float)at.y));
    ImGui::SetNextWindowSize(ImVec2((float)at.width, (float)at.height));
    ImGui::Begin(name, nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoSavedSettings);
}

void ui_panel_end(void) {
    ImGui::End();
}

bool ui_dialog(const char *name, window_rect at, bool below, bool *open) {
    float border = below ? ImGui::GetFontSize() * 0.5f : 0, part = below ? 1 : 0.5f;
    float width = ImGui::GetFontSize() * 36; /* lines longer than that are hard to read */
    width = width < (float)at.width ? width : (float)at.width;
    ImGui::SetNextWindowPos(ImVec2((float)at.x + (float)at.width * 0.5f,
                                   (float)at.y + (float)at.height * part - border),
                            ImGuiCond_Always, ImVec2(0.5f, part));
    ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0), ImVec2(width, (float)at.height));
    return ImGui::Begin(name, open,
                        ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize |
                            ImGuiWindowFlags_NoSavedSettings);
}

void ui_scroll(const char *name, float height) {
    ImGui::BeginChild(name, ImVec2(0, height));
}

void ui_scroll_end(void) {
    ImGui::EndChild();
}

bool ui_tabs(const char *name) {
    return ImGui::BeginTabBar(name);
}

void ui_tabs_end(void) {
    ImGui::EndTabBar();
}

bool ui_tab(const char *name) {
    bool open = ImGui::BeginTabItem(name);
    place(name, ImGui::GetItemRectMin(), ImGui::GetItemRectMax());
    return open;
}

void ui_tab_end(void) {
    ImGui::EndTabItem();
}

bool ui_section(const char *name, bool open) {
    return placed(name, ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0));
}

void ui_unfold(void) {
    ImGui::SetNextItemOpen(true);
}

void ui_group(int id) {
    ImGui::PushID(id);
}

void ui_group_end(void) {
    ImGui::PopID();
}

// ---- widgets ----

void ui_widget_name(const char *name) {
    ui->name = name;
}

void ui_text(const char *text) {
    ImGui::TextUnformatted(text);
}

void ui_label(const char *text) {
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(text);
}

void ui_text_wrapped(const char *text) {
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
}

void ui_text_dim(const char *text) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyle().Colors[ImGuiCol_TextDisabled]);
    ui_text_wrapped(text);
    ImGui::PopStyleColor();
}

void ui_text_error(const char *text) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1.0f, 0.62f, 0.5f, 1));
    ui_text_wrapped(text);
    ImGui::PopStyleColor();
}

bool ui_button(const char *label) {
    return placed(label, ImGui::Button(label));
}

bool ui_small_button(const char *label) {
    return placed(label, ImGui::SmallButton(label));
}

void ui_no_button(const char *label) {
    const ImGuiStyle &style = ImGui::GetStyle();
    ImGui::Dummy(ImVec2(ImGui::CalcTextSize(label, nullptr, true).x + 2 * style.FramePadding.x, 0));
}

bool ui_toggle(const char *label, bool *value) {
    return placed(label, ImGui::Checkbox(label, value));
}

bool ui_choice(const char *label, bool chosen) {
    return placed(label, ImGui::RadioButton(label, chosen));
}

bool ui_combo(const char *label, int *chosen, const char *choices) {
    std::vector<std::string> items(1);
    for (const char *c = choices; *c; c++) {
        if (*c == '|')
            items.emplace_back();
        else
            items.back() += *c;
    }
    const char *shown =
        *chosen >= 0 && *chosen < (int)items.size() ? items[(size_t)*chosen].c_str() : "";
    bool changed = false;
    if (!ImGui::BeginCombo(label, shown, ImGuiComboFlags_HeightLarge))
        return placed(label, false);
    for (int i = 0; i < (int)items.size(); i++) {
        const std::string &item = items[(size_t)i];
        bool now = ImGui::Selectable(item.c_str(), i == *chosen);
        if (placed((std::string(label) + " " + item).c_str(), now)) {
            changed = i != *chosen;
            *chosen = i;
        }
        if (i == *chosen && ImGui::IsWindowAppearing())
            ImGui::SetScrollHereY();
    }
    ImGui::EndCombo();
    return changed;
}

bool ui_slider(const char *label, float *value, float low, float high, const char *format) {
    return placed(
        label, ImGui::SliderFloat(label, value, low, high, format, ImGuiSliderFlags_AlwaysClamp));
}

bool ui_slider_int(const char *label, int *value, int low, int high, const char *format) {
    return placed(label,
                  ImGui::SliderInt(label, value, low, high, format, ImGuiSliderFlags_AlwaysClamp));
}

bool ui_drag(const char *label, float *value, float speed, float low, float high,
             const char *format) {
    return placed(label, ImGui::DragFloat(label, value, speed, low, high, format,
                                          ImGuiSliderFlags_AlwaysClamp));
}

bool ui_input(const char *label, char *text, int size, const char *hint) {
    ImGui::InputTextWithHint(label, hint, text, (size_t)size);
    return placed(label, ImGui::IsItemDeactivatedAfterEdit());
}

bool ui_item(const char *label, bool selected) {
    return placed(label, ImGui::Selectable(label, selected));
}

void ui_progress(float part, const char *text) {
    ImGui::ProgressBar(part, ImVec2(-1, 0), text);
}

void ui_tip(const char *text) {
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 26);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

void ui_help(const char *text) {
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
        ui_tip(text);
}

bool ui_hovered(void) {
    return ImGui::IsItemHovered();
}

void ui_same_line(void) {
    ImGui::SameLine();
}

void ui_space(void) {
    ImGui::Spacing();
}

void ui_line(void) {
    ImGui::Separator();
}

void ui_width(float width) {
    ImGui::SetNextItemWidth(width);
}

void ui_width_left(float *width) {
    *width = ImGui::GetContentRegionAvail().x;
}

float ui_height_left(void) {
    return ImGui::GetContentRegionAvail().y;
}

bool ui_table(const char *name, int columns, int widest) {
    if (!ImGui::BeginTable(name, columns, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit))
        return false;
    for (int i = 0; i < columns; i++)
        ImGui::TableSetupColumn("", i == widest ? ImGuiTableColumnFlags_WidthStretch
                                                : ImGuiTableColumnFlags_WidthFixed);
    return true;
}

void ui_cell(void) {
    ImGui::TableNextColumn();
}

void ui_table_end(void) {
    ImGui::EndTable();
}

void ui_disable(bool disabled) {
    ImGui::BeginDisabled(disabled);
}

void ui_disable_end(void) {
    ImGui::EndDisabled();
}

// ---- drawing ----

ui_area ui_canvas(const char *label, float width, float height) {
    ImGuiIO &io = ImGui::GetIO();
    ImVec2 at = ImGui::GetCursorScreenPos(), dragged = ImGui::GetMouseDragDelta(0);
    bool let_go = ImGui::InvisibleButton(label, ImVec2(width, height));
    ImGui::SetItemUsingMouseWheel(); // it does not scroll the panel
    placed(label, false);
    ui_area area = {};
    area.x = at.x;
    area.y = at.y;
    area.width = width;
    area.height = height;
    area.pointer[0] = io.MousePos.x;
    area.pointer[1] = io.MousePos.y;
    area.hovered = ImGui::IsItemHovered();
    area.pressed = ImGui::IsItemActive();
    area.clicked = let_go && dragged.x == 0 && dragged.y == 0;
    if (area.pressed && ImGui::IsMouseDragging(0)) {
        area.moved[0] = io.MouseDelta.x;
        area.moved[1] = io.MouseDelta.y;
    }
    if (area.hovered)
        area.wheel = io.MouseWheel;
    return area;
}

void ui_draw_line(bool over, float ax, float ay, float bx, float by, uint32_t color, float width) {
    list_of(over)->AddLine(ImVec2(ax, ay), ImVec2(bx, by), color_of(color), width);
}

void ui_draw_box(bool over, float ax, float ay, float bx, float by, uint32_t color) {
    list_of(over)->AddRectFilled(ImVec2(ax, ay), ImVec2(bx, by), color_of(color));
}

void ui_draw_disc(bool over, float x, float y, float radius, uint32_t color) {
    list_of(over)->AddCircleFilled(ImVec2(x, y), radius, color_of(color));
}

void ui_draw_ring(bool over, float x, float y, float radius, uint32_t color, float width) {
    list_of(over)->AddCircle(ImVec2(x, y), radius, color_of(color), 0, width);
}

void ui_draw_text(bool over, float x, float y, uint32_t color, const char *text) {
    list_of(over)->AddText(ImVec2(x, y), color_of(color), text);
}

void ui_clip(bool over, window_rect at) {
    list_of(over)->PushClipRect(ImVec2((float)at.x, (float)at.y),
                                ImVec2((float)(at.x + at.width), (float)(at.y + at.height)),
                                !over); // nor out of the panel
}

void ui_clip_end(bool over) {
    list_of(over)->PopClipRect();
}

float ui_text_width(const char *text) {
    return ImGui::CalcTextSize(text, nullptr, true).x;
}

float ui_text_height(void) {
    return ImGui::GetTextLineHeightWithSpacing();
}

void ui_copy(const char *text) {
    ImGui::SetClipboardText(text);
}
}
