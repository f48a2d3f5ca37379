!> The &output group: where results go and how often.
module output_settings
  use case_keys, only: keys_t
  use constants, only: unset
  use kinds, only: wp
  use text, only: word_length, line_length
  implicit none
  private
  public :: output_settings_t, declare_output

  !> An interval that is unset writes nothing of its kind, but the restart file is written at the end all
  !> the same.
  type :: output_settings_t
    character(len=line_length) :: folder = 'results'     !< relative to the case file
    real(wp) :: parcels_interval = unset                 !< parcels.vtkhdf [s]
    real(wp) :: gas_interval = unset                     !< gas.vtkhdf [s]
    real(wp) :: restart_interval = unset                 !< restart.h5 [s]
    real(wp) :: monitor_interval = unset                 !< monitor.h5 [s]; unset: every gas step
    character(len=word_length) :: progress = 'bar'       !< 'bar' | 'lines' | 'none'
  end type output_settings_t

contains

  !> The keys of the open group.
  subroutine declare_output(settings, keys)
    type(output_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    call keys%get_path('folder', settings%folder, 'folder of the results, relative to the case file', must_exist=.false.)
    call keys%get('parcels_interval', settings%parcels_interval, 'between frames of parcels.vtkhdf; none if not given [s]', &
                  '(0, inf)')
    call keys%get('gas_interval', settings%gas_interval, 'between frames of gas.vtkhdf; none if not given [s]', '(0, inf)')
    call keys%get('restart_interval', settings%restart_interval, &
                  'between restart files; only at the end if not given [s]', '(0, inf)')
    call keys%get('monitor_interval', settings%monitor_interval, &
                  'between rows of monitor.h5; every gas step if not given [s]', '(0, inf)')
    call keys%get('progress', settings%progress, 'what the screen shows: a bar (lines where there is no terminal), '// &
                  'lines, nothing', 'bar | lines | none')
  end subroutine declare_output

end module output_settings
