!> What a run cost: wall time by part, and the work done in it.
module cost
  use, intrinsic :: iso_fortran_env, only: output_unit
  use kinds, only: wp
  use ledger, only: ledger_t
  use scene, only: scene_t, parts, part_gas, part_parcels
  use timing, only: print_times
  implicit none
  private
  public :: print_cost

contains

  !> The bill of this launch of the program. All ranks take part; the root prints.
  subroutine print_cost(scene, now, before, time_before)
    type(scene_t), intent(inout) :: scene
    type(ledger_t), intent(in) :: now, before  !< the books now and when this launch began
    real(wp), intent(in) :: time_before        !< simulated time when it began [s]

    real(wp), dimension(size(parts) + 1) :: seconds, mean, least, most  ! the last is all the rest
    real(wp) :: wall, simulated, work

    seconds = scene%watch%seconds()
    mean = scene%comm%sum(seconds)/scene%comm%size
    most = scene%comm%max(seconds)
    least = -scene%comm%max(-seconds)
    if (.not. scene%comm%is_root()) return
    print '(a)', 'cost'
    call print_times(output_unit, scene%watch%part_names(), least, mean, most)
    wall = sum(mean)
    simulated = scene%time - time_before
    if (simulated > 0) call line('wall seconds per simulated second', wall/simulated)
    work = now%parcel_steps - before%parcel_steps
    if (work > 0) then
      call line('solids steps', now%solids_steps - before%solids_steps)
      call line('million parcel steps per second of all', work/wall*1.0e-6_wp)
      call line('million parcel steps per second in parcels', work/mean(part_parcels)*1.0e-6_wp)
    end if
    work = (now%iterations - before%iterations)
    if (scene%with_gas .and. work > 0) then
      associate (steps => now%gas_steps - before%gas_steps, cells => product(real(scene%mesh%n, wp)))
        call line('gas steps', steps)
        call line('gas steps repeated', now%retries - before%retries)
        call line('SIMPLE iterations per step', work/steps)
        call line('pressure iterations per step', (now%pressure_iterations - before%pressure_iterations)/steps)
        call line('million cell steps per second in gas', steps*cells/mean(part_gas)*1.0e-6_wp)
        call line('microseconds per cell and SIMPLE iteration', mean(part_gas)/(work*cells)*1.0e6_wp)
      end associate
    end if
  end subroutine print_cost

  subroutine line(what, x)
    character(len=*), intent(in) :: what
    real(wp), intent(in) :: x

    print '(2x,a,t46,g12.5)', what, x
  end subroutine line

end module cost
