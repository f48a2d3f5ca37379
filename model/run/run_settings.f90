!> The &run group: what is computed and for how long.
module run_settings
  use case_keys, only: keys_t
  use constants, only: unset
  use kinds, only: wp
  use text, only: line_length
  implicit none
  private
  public :: run_settings_t, declare_run

  type :: run_settings_t
    character(len=line_length) :: title = ''     !< written into every result
    real(wp) :: end_time = unset                 !< simulated time at which the run ends [s]
    real(wp) :: wall_clock_limit = unset         !< stop with a checkpoint after this long [s]
  end type run_settings_t

contains

  !> The keys of the open group.
  subroutine declare_run(settings, keys)
    type(run_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    call keys%get('title', settings%title, 'title, written into every result')
    call keys%get('end_time', settings%end_time, 'simulated time at which the run ends [s]', '(0, inf)', &
                  required=.true., when='always')
    call keys%get('wall_clock_limit', settings%wall_clock_limit, &
                  'real time after which the run writes a restart file and stops [s]', '(0, inf)')
  end subroutine declare_run

end module run_settings
