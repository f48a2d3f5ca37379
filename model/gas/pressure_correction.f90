!> Continuity of the gas and the pressure that enforces it.
!>
!>   rho V (eps - eps_old)/dt + sum of G_out = 0,    G = rho eps_f A u
!>
!> A pressure correction p' changes the velocities by u' = -d (p'_above - p'_below); put into the continuity
!> equation it gives sum over faces of c (p' - p'_beyond) = -imbalance with c = rho eps_f A d.
module pressure_correction
  use gas_state, only: gas_state_t, unit_step
  use kinds, only: wp
  implicit none
  private
  public :: prepare_faces, prepare_pressure, update_flux, find_imbalance, correct

contains

  !> Void fraction on faces, and the given velocities: superficial velocity over void fraction.
  subroutine prepare_faces(state)
    class(gas_state_t), intent(inout) :: state

    integer :: a, i, j, k, e(3)

    do a = 1, 3
      e = unit_step(a)
      associate (n => state%boxes%n, eps => state%eps)
        do k = -1, n(3) + 1
          do j = -1, n(2) + 1
            do i = -1, n(1) + 1
              state%eps_face(i, j, k, a) = 0.5_wp*(eps(i, j, k) + eps(i + e(1), j + e(2), k + e(3)))
            end do
          end do
        end do
      end associate
      call set_side(state, a, 1)
      call set_side(state, a, 2)
    end do
  end subroutine prepare_faces

  subroutine set_side(state, a, end)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a, end

    integer :: i, j, k, lo(3), hi(3), inner(3)
    real(wp) :: inward

    if (.not. state%boundary%side(end, a)%mine) return
    lo = 0
    hi = state%boxes%n + 1
    lo(a) = merge(0, state%boxes%n(a), end == 1)
    hi(a) = lo(a)
    inner = merge(1, 0, end == 1)*unit_step(a)
    inward = merge(1.0_wp, -1.0_wp, end == 1)
    associate (side => state%boundary%side(end, a), eps => state%eps)
      do k = lo(3), hi(3)
        do j = lo(2), hi(2)
          do i = lo(1), hi(1)
            state%eps_face(i, j, k, a) = eps(i + inner(1), j + inner(2), k + inner(3))
            if (side%open(i, j, k)) cycle
            if (state%eps_face(i, j, k, a) <= 0.0_wp) cycle  ! the rim beyond the domain
            state%velocity(i, j, k, a) = inward*side%flow(i, j, k)/state%eps_face(i, j, k, a)
          end do
        end do
      end do
    end associate
  end subroutine set_side

  !> The matrix of the pressure correction, the same for all iterations of a step.
  subroutine prepare_pressure(state)
    class(gas_state_t), intent(inout) :: state

    integer :: a

    ! the fluxes are made anew right after: their storage serves for the coefficients
    do a = 1, 3
      state%flux(:, :, :, a) = state%density*state%mesh%area(a)*state%eps_face(:, :, :, a)*state%mobility(:, :, :, a)
    end do
    call state%halo%exchange_many(state%flux)
    call state%solver%set_matrix(state%flux)
  end subroutine prepare_pressure

  !> Mass flow through all faces of the box and one layer around it.
  subroutine update_flux(state)
    class(gas_state_t), intent(inout) :: state

    integer :: a, i, j, k
    real(wp) :: scale

    associate (n => state%boxes%n)
      do a = 1, 3
        scale = state%density*state%mesh%area(a)
        do k = 0, n(3) + 1
          do j = 0, n(2) + 1
            do i = 0, n(1) + 1
              state%flux(i, j, k, a) = scale*state%eps_face(i, j, k, a)*state%velocity(i, j, k, a)
            end do
          end do
        end do
      end do
    end associate
  end subroutine update_flux

  !> What each cell loses and stores, which should be nothing, and the sum of its size over all ranks [kg/s].
  function find_imbalance(state, dt) result(total)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(in) :: dt  !< [s]
    real(wp) :: total

    integer :: i, j, k
    real(wp) :: scale

    scale = state%density*state%mesh%volume/dt
    total = 0.0_wp
    associate (n => state%boxes%n, g => state%flux)
      do k = 1, n(3)
        do j = 1, n(2)
          !$omp simd reduction(+:total)
          do i = 1, n(1)
            state%imbalance(i, j, k) = scale*(state%eps(i, j, k) - state%eps_old(i, j, k)) &
              + (g(i, j, k, 1) - g(i - 1, j, k, 1)) + (g(i, j, k, 2) - g(i, j - 1, k, 2)) &
              + (g(i, j, k, 3) - g(i, j, k - 1, 3))
            total = total + abs(state%imbalance(i, j, k))
          end do
        end do
      end do
    end associate
    total = state%boxes%comm%sum(total)
  end function find_imbalance

  !> Solve for the pressure that takes the imbalance away, all but the part `reduction`, and apply it.
  subroutine correct(state, reduction)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(in) :: reduction

    integer :: a, i, j, k, e(3), iterations

    state%imbalance = -state%imbalance
    call state%solver%solve(state%imbalance, reduction, state%correction, iterations)
    state%report%pressure_iterations = state%report%pressure_iterations + iterations
    call state%halo%exchange(state%correction)
    do a = 1, 3
      if (.not. state%stencil(a)%active) cycle
      e = unit_step(a)
      associate (first => state%first(:, a), n => state%boxes%n, p => state%correction)
        do k = first(3), n(3)
          do j = first(2), n(2)
            do i = first(1), n(1)
              state%velocity(i, j, k, a) = state%velocity(i, j, k, a) &
                - state%mobility(i, j, k, a)*(p(i + e(1), j + e(2), k + e(3)) - p(i, j, k))
            end do
          end do
        end do
      end associate
    end do
    call add_correction(state)
    call state%halo%exchange(state%pressure)
    call state%halo%exchange_many(state%velocity)
  end subroutine correct

  !> p + p' - mu div(eps u)/eps with the divergence that the correction takes away: the viscous stress of the velocity
  !> change, which the mobilities leave out, is a pressure too. Without it a step much longer than the viscous time of
  !> a cell takes tens of iterations (Cahouet and Chabard, Int. J. Numer. Meth. Fluids 8 (1988) 869; Guermond and Shen,
  !> Math. Comput. 73 (2004) 1719, eq. 3.6).
  subroutine add_correction(state)
    class(gas_state_t), intent(inout) :: state

    integer :: i, j, k
    real(wp) :: scale, level

    scale = state%viscosity/(state%density*state%mesh%volume)
    associate (n => state%boxes%n, p => state%correction)
      do k = 1, n(3)
        do j = 1, n(2)
          do i = 1, n(1)
            p(i, j, k) = p(i, j, k) + scale/state%eps(i, j, k)*state%imbalance(i, j, k)
          end do
        end do
      end do
      level = 0.0_wp
      if (.not. state%boundary%any_open) then
        ! nothing gives the level of the pressure: the first cell of the grid keeps its own
        if (all(state%boxes%lo == 1)) level = p(1, 1, 1)
        level = state%boxes%comm%sum(level)
      end if
      state%pressure(1:n(1), 1:n(2), 1:n(3)) = state%pressure(1:n(1), 1:n(2), 1:n(3)) &
        + (p(1:n(1), 1:n(2), 1:n(3)) - level)
    end associate
  end subroutine add_correction

end module pressure_correction
