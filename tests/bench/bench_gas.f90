!> Cost of the gas on a bed-like void fraction and drag that change from step to step.
!> usage: bench_gas nx ny nz [steps] [tolerance]
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
  type(communicator_t) :: comm
  type(boxes_t) :: boxes
  type(mesh_t) :: mesh
  type(gas_t) :: gas
  type(gas_settings_t) :: settings
  type(gas_numerics_t) :: numerics
  type(boundary_settings_t) :: records(2)
  type(outcome_t) :: outcome
  integer :: cells(3), steps, step, iterations, pressure_iterations, sweeps
  real(wp) :: from, to, seconds, worst
  logical :: converged

  call start_ranks(comm)
  cells = [argument(1, 16), argument(2, 120), argument(3, 4)]
  steps = argument(4, 50)
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
  gas%gravity = [0.0_wp, -9.81_wp, 0.0_wp]
  call set_bed(gas, 0)
  call gas%accept()
  iterations = 0
  pressure_iterations = 0
  sweeps = 0
  seconds = 0.0_wp
  worst = 0.0_wp
  do step = 1, steps
    call set_bed(gas, step)
    call comm%barrier()
    call cpu_time(from)  ! processor time: other programs on the machine do not count
    call gas%advance(dt, converged)
    call gas%accept()
    call cpu_time(to)
    associate (r => gas%report)
      if (comm%is_root() .and. (.not. converged .or. step <= 5 .or. modulo(step, 10) == 0)) then
        print '(i5,l2,3i5,5es10.2)', step, converged, r%iterations, r%sweeps, r%pressure_iterations, r%mass_imbalance, &
          r%mass_residual, r%momentum_residual, r%courant, to - from
      end if
      if (step <= 2) cycle
      seconds = seconds + to - from
      iterations = iterations + r%iterations
      pressure_iterations = pressure_iterations + r%pressure_iterations
      sweeps = sweeps + r%sweeps
      worst = max(worst, r%mass_imbalance)
    end associate
  end do
  if (comm%is_root()) then
    print '(a,f8.3,a,f7.2,a,f7.2,a,f7.2,a,f9.3,a,es9.2)', 'us per cell and iteration ', &
      1.0e6_wp*seconds/(iterations*product(real(cells, wp))), '  iterations per step ', iterations/real(steps - 2, wp), &
      '  sweeps ', sweeps/real(steps - 2, wp), '  pressure ', pressure_iterations/real(steps - 2, wp), &
      '  ms per step ', 1.0e3_wp*seconds/(steps - 2), '  worst imbalance ', worst
    print '(a,es12.4,a)', 'bench gas_cell_iteration ', 1.0e6_wp*seconds/(iterations*product(real(cells, wp))), ' us'
    print '(a,es12.4,a)', 'bench gas_step ', 1.0e3_wp*seconds/(steps - 2), ' ms'
    print '(a,es12.4,a)', 'bench gas_iterations ', iterations/real(steps - 2, wp), ' 1'
  end if
  call gas%destroy()
  call stop_ranks()

contains

  integer function argument(place, usual)
    integer, intent(in) :: place, usual

    character(len=16) :: word

    argument = usual
    if (command_argument_count() < place) return
    call get_command_argument(place, word)
    read (word, *) argument
  end function argument

  !> A bed up to half of the height with bubbles that rise at 0.3 m/s and noise of its own in every cell and step.
  subroutine set_bed(gas, step)
    type(gas_t), intent(inout) :: gas
    integer, intent(in) :: step

    integer :: i, j, k, bubble
    real(wp) :: x(3), centre(3), eps, noise, height, solids

    height = 0.5_wp*(mesh%upper(2) - mesh%lower(2))
    associate (lo => boxes%lo, n => boxes%n)
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
