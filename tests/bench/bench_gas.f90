!> Cost of the gas on a bed-like void fraction and drag that change from step to step, in the vessel of cases/geldart_b_bed and
!> in larger ones of the same shape and the same cells.
!>
!> usage: bench_gas FOLDER [nx ny nz steps]     without numbers four grids; FOLDER is not used
! ranks: 1 2
program bench_gas
  use boundary_settings, only: boundary_settings_t
  use boxes, only: boxes_t, new_boxes
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use gas, only: gas_t, new_gas
  use gas_numerics, only: gas_numerics_t
  use gas_settings, only: gas_settings_t
  use kinds, only: wp
  use mesh, only: mesh_t, new_uniform_mesh
  use outcome, only: outcome_t
  implicit none

  real(wp), parameter :: edge = 4.0e-3_wp, dt = 1.0e-3_wp, speed = 0.45_wp
  integer, parameter :: warm = 2  !< first steps, which do not count
  type(communicator_t) :: comm

  call start_ranks(comm)
  if (command_argument_count() > 4) then
    call measure([number(2), number(3), number(4)], number(5))
  else
    call measure([16, 120, 4], 100)
    call measure([32, 240, 8], 20)
    call measure([64, 480, 16], 8)
    call measure([80, 600, 20], 5)
  end if
  call stop_ranks()

contains

  integer function number(place)
    integer, intent(in) :: place

    character(len=16) :: word

    call get_command_argument(place, word)
    read (word, *) number
  end function number

  !> So many steps on a grid, after two that do not count.
  subroutine measure(cells, steps)
    integer, intent(in) :: cells(3), steps

    type(gas_t) :: gas
    integer :: step
    real(wp) :: from, to, seconds, counts(3), worst
    logical :: converged
    character(len=16) :: size

    call make(cells, gas)
    seconds = 0.0_wp
    counts = 0.0_wp
    worst = 0.0_wp
    do step = 1, steps + warm
      call set_bed(gas, step)
      call comm%barrier()
      call cpu_time(from)  ! processor time: other programs on the machine do not count
      call gas%advance(dt, converged)
      call gas%accept()
      call cpu_time(to)
      if (.not. converged) print '(a,i0)', 'bench_gas: no convergence in step ', step
      if (step <= warm) cycle
      seconds = seconds + to - from
      associate (r => gas%report)
        counts = counts + [r%iterations, r%sweeps, r%pressure_iterations]
        worst = max(worst, r%mass_imbalance)
      end associate
    end do
    seconds = comm%max(seconds)
    call gas%destroy()
    if (.not. comm%is_root()) return
    write (size, '(i0)') product(cells)
    print '(a,3(i0,1x),a,es9.2)', 'grid ', cells, ' worst imbalance ', worst
    call tell('iteration_'//size, 1.0e6_wp*seconds/(counts(1)*product(real(cells, wp))), 'us/cell')
    call tell('step_'//size, 1.0e3_wp*seconds/steps, 'ms')
    call tell('iterations_'//size, counts(1)/steps, '1')
    call tell('sweeps_'//size, counts(2)/steps, '1')
    call tell('pressure_'//size, counts(3)/counts(1), '1')
  end subroutine measure

  subroutine tell(what, value, unit)
    character(len=*), intent(in) :: what, unit
    real(wp), intent(in) :: value

    print '(3a,es12.4,2a)', 'bench gas_', trim(what), ' ', value, ' ', unit
  end subroutine tell

  subroutine make(cells, gas)
    integer, intent(in) :: cells(3)
    type(gas_t), intent(out) :: gas

    type(boxes_t) :: boxes
    type(mesh_t) :: mesh
    type(gas_settings_t) :: settings
    type(gas_numerics_t) :: numerics
    type(boundary_settings_t) :: records(2)
    type(outcome_t) :: outcome

    mesh = new_uniform_mesh([0.0_wp, 0.0_wp, 0.0_wp], edge*cells, cells, [.false., .false., .false.])
    call new_boxes(comm, cells, mesh%periodic, boxes, outcome)
    records(1)%id = 'bottom'
    records(1)%lower = 0.0_wp
    records(1)%upper = [mesh%upper(1), 0.0_wp, mesh%upper(3)]
    records(1)%kind = 'inflow'
    records(1)%velocity = speed
    records(2)%id = 'top'
    records(2)%lower = [0.0_wp, mesh%upper(2), 0.0_wp]
    records(2)%upper = mesh%upper
    records(2)%kind = 'outflow'
    settings%velocity = [0.0_wp, speed, 0.0_wp]
    call new_gas(boxes, mesh, settings, records, numerics, gas, outcome)
    if (outcome%failed()) error stop 'bench_gas: the gas cannot be made'
    gas%gravity = [0.0_wp, -9.81_wp, 0.0_wp]
    call set_bed(gas, 0)
    call gas%accept()
  end subroutine make

  !> A bed up to half of the height with bubbles that rise at 0.3 m/s and noise of its own in every cell and step.
  subroutine set_bed(gas, step)
    type(gas_t), intent(inout) :: gas
    integer, intent(in) :: step

    integer :: i, j, k, bubble
    real(wp) :: x(3), centre(3), eps, noise, height, solids

    height = 0.5_wp*(gas%mesh%upper(2) - gas%mesh%lower(2))
    associate (lo => gas%boxes%lo, n => gas%boxes%n, mesh => gas%mesh)
      do k = 1, n(3)
        do j = 1, n(2)
          do i = 1, n(1)
            x = (lo + [i, j, k] - 1.5_wp)*mesh%finest
            solids = 0.55_wp/(1 + exp((x(2) - height)/edge))
            do bubble = 0, 7
              centre = [mesh%upper(1)*modulo(0.37_wp*bubble + 0.2_wp, 1.0_wp), &
                        modulo(bubble*height/8 + 0.3_wp*dt*step, height), mesh%upper(3)*modulo(0.61_wp*bubble + 0.5_wp, 1.0_wp)]
              solids = solids*(1 - exp(-sum(((x - centre)/(2.5_wp*edge))**2)))
            end do
            noise = hash(lo(1) + i, lo(2) + j, lo(3) + k, 0) + 0.02_wp*hash(lo(1) + i, lo(2) + j, lo(3) + k, step)
            eps = 1 - solids*(1 + 0.1_wp*noise)
            gas%eps(i, j, k) = eps
            ! Ergun for 0.56 mm beads at 0.3 m/s slip
            gas%drag(i, j, k) = product(mesh%finest)*(150*(1 - eps)**2*1.8e-5_wp/(eps*0.56e-3_wp**2) &
                                            + 1.75_wp*1.2_wp*(1 - eps)*0.3_wp/0.56e-3_wp)
            gas%drag_source(:, i, j, k) = gas%drag(i, j, k)*0.2_wp*[hash(i, j, k, step + 7), 1.0_wp, hash(k, j, i, step + 9)]
          end do
        end do
      end do
    end associate
  end subroutine set_bed

  !> Between -1 and 1.
  pure function hash(i, j, k, m) result(x)
    integer, intent(in) :: i, j, k, m
    real(wp) :: x

    x = sin(12.9898_wp*i + 78.233_wp*j + 37.719_wp*k + 3.1_wp*m)*43758.5453_wp
    x = 2*(x - floor(x)) - 1
  end function hash

end program bench_gas
