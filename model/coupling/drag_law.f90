!> The drag law of a run: one law for all particles, chosen once per block of them.
module drag_law
  use drag_beetstra, only: beetstra
  use drag_cello, only: cello
  use drag_di_felice, only: di_felice, di_felice_sn
  use drag_ergun, only: ergun
  use drag_gidaspow, only: gidaspow
  use drag_gidaspow_blend, only: gidaspow_blend
  use drag_koch_hill, only: koch_hill
  use drag_rong, only: rong
  use drag_syamlal_obrien, only: syamlal_obrien
  use drag_tang, only: tang
  use drag_tenneti, only: tenneti
  use drag_wen_yu, only: wen_yu
  use kinds, only: wp
  implicit none
  private
  public :: drag_law_t, new_drag_law, law_names

  !> What a case may ask for.
  character(len=*), parameter :: law_names(13) = [character(len=14) :: &
    'wen_yu', 'ergun', 'gidaspow', 'gidaspow_blend', 'syamlal_obrien', 'beetstra', 'tang', 'tenneti', 'koch_hill', &
    'di_felice', 'di_felice_sn', 'rong', 'cello']

  type :: drag_law_t
    private
    character(len=14) :: name  !< one of law_names
    real(wp) :: c1, d1         !< of syamlal_obrien [-]
  contains
    procedure :: find_factors
    procedure :: factor_at
  end type drag_law_t

contains

  function new_drag_law(name, c1, d1) result(law)
    character(len=*), intent(in) :: name            !< one of law_names
    real(wp), intent(in), optional :: c1, d1        !< of syamlal_obrien, 0.8 and 2.65 unless given [-]
    type(drag_law_t) :: law

    law%c1 = 0.8_wp
    law%d1 = 2.65_wp
    if (present(c1)) law%c1 = c1
    if (present(d1)) law%d1 = d1
    if (.not. any(law_names == name)) error stop 'drag_law: the case reader let an unknown drag law pass'
    law%name = name
  end function new_drag_law

  !> F of many particles.
  pure subroutine find_factors(self, reynolds, eps, factor)
    class(drag_law_t), intent(in) :: self
    real(wp), intent(in) :: reynolds(:)      !< (n) Re = rho_g eps |w| d/mu [-]
    real(wp), intent(in) :: eps(:)           !< (n) void fraction [-]
    real(wp), intent(inout) :: factor(:)     !< (n) drag force over 3 pi mu d eps |w| [-]

    select case (self%name)
    case ('wen_yu')
      factor = wen_yu(reynolds, eps)
    case ('ergun')
      factor = ergun(reynolds, eps)
    case ('gidaspow')
      factor = gidaspow(reynolds, eps)
    case ('gidaspow_blend')
      factor = gidaspow_blend(reynolds, eps)
    case ('syamlal_obrien')
      factor = syamlal_obrien(reynolds, eps, self%c1, self%d1)
    case ('beetstra')
      factor = beetstra(reynolds, eps)
    case ('tang')
      factor = tang(reynolds, eps)
    case ('tenneti')
      factor = tenneti(reynolds, eps)
    case ('koch_hill')
      factor = koch_hill(reynolds, eps)
    case ('di_felice')
      factor = di_felice(reynolds, eps)
    case ('di_felice_sn')
      factor = di_felice_sn(reynolds, eps)
    case ('rong')
      factor = rong(reynolds, eps)
    case default
      factor = cello(reynolds, eps)
    end select
  end subroutine find_factors

  !> F of one particle.
  pure function factor_at(self, reynolds, eps) result(factor)
    class(drag_law_t), intent(in) :: self
    real(wp), intent(in) :: reynolds, eps  !< [-]
    real(wp) :: factor                     !< [-]

    real(wp) :: values(1)

    call self%find_factors([reynolds], [eps], values)
    factor = values(1)
  end function factor_at

end module drag_law
